// What a shell writes where a variable is not set: options with nothing for a value.
#include "client/command/arguments/empty_values.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/command/command.h"
#include "core/base/bare_option.h"

namespace tet {
namespace {

using testing::HasSubstr;

/// What is said of the words, in the order of a command line; empty where nothing is wrong with
/// them.
std::string refusal_of(CLI::App& app, std::vector<std::string> words) {
  std::reverse(words.begin(), words.end());  // as CLI11 takes them
  try {
    app.parse(std::move(words));
  } catch (const CLI::ParseError& error) {
    return error.what();
  }
  return "";
}

void expect_refusals(CLI::App& app) {
  for (CLI::App* const command : app.get_subcommands([](CLI::App*) { return true; })) {
    expect_refusals(*command);
  }
  for (const CLI::Option* const option : app.get_options()) {
    if (option->get_items_expected_max() == 0 || option->get_positional()) continue;
    if (option->check_lname("grid")) continue;
    const std::string name = option->get_name();
    EXPECT_THAT(refusal_of(app, {option->get_name(), ""}), testing::StartsWith(name)) << name;
  }
}

TEST(EmptyValues, AreRefusedOfEveryOptionOfEveryCommand) {
  for (const auto describe :
       {add_mesh_command, add_report_command, add_transfer_command, add_sample_command,
        add_estimate_command, add_info_command, add_convert_command, add_formats_command,
        add_health_command, add_job_command}) {
    CLI::App app;
    const Command command = describe(app);
    refuse_empty_values(app);
    expect_refusals(app);
  }
}

TEST(EmptyValues, AreNamesOfGrids) {
  CLI::App app;
  const Command command = add_info_command(app);
  std::vector<std::string> grids;
  std::string other;
  app.add_option("--grid", grids)->allow_extra_args(false);
  app.add_option("--other", other);
  refuse_empty_values(app);
  EXPECT_EQ(refusal_of(app, {"a.vdb", "--grid", ""}), "");
  EXPECT_THAT(refusal_of(app, {"a.vdb", "--other", ""}), HasSubstr("it is empty"));
}

TEST(EmptyValues, AreFoundBehindTheSignOfAnOption) {
  EXPECT_EQ(option_without_value({"mesh", "--report=", "--improve"}), "--report");
  EXPECT_EQ(option_without_value({"--label=part=", "a=", "-o", "--iso=0"}), "");
  EXPECT_EQ(option_without_value({"mesh", "--", "--report="}), "");
}

}  // namespace
}  // namespace tet
