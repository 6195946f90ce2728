#include "core/manual/completion.h"

#include <algorithm>

#include <absl/strings/match.h>

namespace tet {

ValueKind kind_of_value(const OptionHelp& option) {
  if (option.value.empty()) return ValueKind::kNone;
  if (!option.choices.empty()) return ValueKind::kChoice;
  // CLI11 calls every string TEXT, paths among them; numbers and words have names of their own.
  const bool may_be_file = option.value == "TEXT" || absl::StrContains(option.value, "FILE");
  return may_be_file ? ValueKind::kFile : ValueKind::kOther;
}

std::vector<OptionHelp> options_of(const CommandHelp& command, const CommandHelp* parent) {
  std::vector<OptionHelp> options = command.options;
  if (!command.takes_parents_options || parent == nullptr) return options;
  // Both may have an option: a worker's settings are some of its server's.
  const auto is_own = [&](const OptionHelp& option) {
    return std::ranges::any_of(command.options, [&](const OptionHelp& own) {
      return own.names.back() == option.names.back();
    });
  };
  for (const OptionHelp& option : parent->options) {
    const std::string& name = option.names.back();
    if (name != "--help" && name != "--version" && !is_own(option)) options.push_back(option);
  }
  return options;
}

}  // namespace tet
