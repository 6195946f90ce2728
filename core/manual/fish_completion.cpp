#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_join.h>
#include <absl/strings/str_replace.h>

#include "core/manual/completion.h"

namespace tet {
namespace {

std::string fish_quoted(const std::string& text) {
  return absl::StrCat("'", absl::StrReplaceAll(text, {{"\\", "\\\\"}, {"'", "\\'"}}), "'");
}

/// True in fish where the command's words were typed, and none of the commands below it.
std::string fish_condition(const CommandHelp& command) {
  std::string condition;
  for (std::size_t i = 1; i < command.path.size(); ++i) {
    absl::StrAppend(&condition, i > 1 ? "; and " : "", "__fish_seen_subcommand_from ",
                    command.path[i]);
  }
  if (command.commands.empty()) return condition;
  absl::StrAppend(&condition, condition.empty() ? "" : "; and ",
                  "not __fish_seen_subcommand_from");
  for (const CommandHelp& each : command.commands) {
    absl::StrAppend(&condition, " ", each.path.back());
  }
  return condition;
}

std::string fish_name(const std::string& name) {
  return absl::StartsWith(name, "--") ? "-l " + name.substr(2) : "-s " + name.substr(1);
}

std::string fish_value(const OptionHelp& option) {
  switch (kind_of_value(option)) {
    case ValueKind::kNone:
      return "";
    case ValueKind::kChoice:
      return " -x -a " + fish_quoted(absl::StrJoin(option.choices, " "));
    case ValueKind::kFile:
      return " -r -F";
    case ValueKind::kOther:
      return " -x";
  }
  return "";
}

std::string fish_lines(const CommandHelp& command, const CommandHelp* parent) {
  const std::string condition = fish_condition(command);
  const std::string start =
      absl::StrCat("complete -c ", command.path.front(),
                   condition.empty() ? "" : " -n " + fish_quoted(condition));
  std::string lines;
  for (const OptionHelp& option : options_of(command, parent)) {
    lines += start;
    for (const std::string& name : option.names) absl::StrAppend(&lines, " ", fish_name(name));
    absl::StrAppend(&lines, fish_value(option), " -d ", fish_quoted(option.about), "\n");
  }
  for (const CommandHelp& each : command.commands) {
    absl::StrAppend(&lines, start, " -f -a ", each.path.back(), " -d ", fish_quoted(each.about),
                    "\n");
  }
  if (command.positionals.empty()) absl::StrAppend(&lines, start, " -f\n");
  for (const CommandHelp& each : command.commands) lines += fish_lines(each, &command);
  return lines;
}

}  // namespace

std::string fish_completion(const CommandHelp& program) {
  return absl::StrCat("# fish completion for ", program.path.front(),
                      ", made from its --help.\n", fish_lines(program, nullptr));
}

}  // namespace tet
