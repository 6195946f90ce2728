#include "client/command/arguments/sizing_input.h"

#include <utility>

#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>

#include "client/command/process/interruption.h"
#include "client/library/text_file.h"
#include "proto/sizing/sizing_message.h"

namespace tet {
namespace {

absl::StatusOr<Sizing> parse_sizing(const std::string& json) {
  const auto message = sizing_from_json(json);
  if (!message.ok()) return message.status();
  if (!message->grid().name().empty()) {
    return absl::InvalidArgumentError(
        "grid.name is for programs: --sizing-grid names the file here");
  }
  return sizing_of_message(*message);
}

}  // namespace

absl::StatusOr<Sizing> read_sizing(const SizingArguments& arguments) {
  Sizing sizing;
  if (!arguments.sizing.empty()) {
    const bool is_text = absl::StartsWith(arguments.sizing, "{");
    const absl::StatusOr<std::string> json =
        is_text ? absl::StatusOr<std::string>(arguments.sizing)
                : read_text_file(arguments.sizing, user_interruption());
    if (!json.ok()) return json.status();
    absl::StatusOr<Sizing> parsed = parse_sizing(*json);
    if (!parsed.ok()) return about(is_text ? "--sizing" : arguments.sizing, parsed.status());
    sizing = *std::move(parsed);
  }
  if (arguments.grid.empty()) return sizing;
  if (!sizing.grid) sizing.grid.emplace();
  sizing.grid->file = arguments.grid;
  return sizing;
}

}  // namespace tet
