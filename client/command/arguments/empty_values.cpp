#include "client/command/arguments/empty_values.h"

#include <CLI/CLI.hpp>
#include <absl/strings/str_cat.h>

namespace tet {
namespace {

constexpr const char* kWhatToDo = "it is empty: give it a value, or leave it out";

bool takes_values(const CLI::Option& option) { return option.get_items_expected_max() > 0; }

}  // namespace

void refuse_empty_values(CLI::App& app) {
  const auto refuse = [](const std::string& value) {
    return value.empty() ? std::string(kWhatToDo) : std::string();
  };
  for (CLI::Option* const option : app.get_options()) {
    if (takes_values(*option) && !option->check_lname("grid")) option->check(refuse);
  }
  for (CLI::App* const command : app.get_subcommands([](CLI::App*) { return true; })) {
    refuse_empty_values(*command);
  }
}

std::string no_value_message(const std::string& option) {
  return absl::StrCat(option, ": ", kWhatToDo);
}

}  // namespace tet
