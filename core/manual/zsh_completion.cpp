#include <absl/strings/str_cat.h>
#include <absl/strings/str_join.h>
#include <absl/strings/str_replace.h>

#include "core/manual/completion.h"

namespace tet {
namespace {

/// Within single quotes, where _arguments takes brackets and colons for its own.
std::string zsh_text(const std::string& text) {
  return absl::StrReplaceAll(
      text, {{"'", "'\\''"}, {"\\", "\\\\"}, {"[", "\\["}, {"]", "\\]"}, {":", "\\:"}});
}

std::string zsh_value(const OptionHelp& option) {
  const std::string title = ":" + zsh_text(option.value);
  switch (kind_of_value(option)) {
    case ValueKind::kNone:
      return "";
    case ValueKind::kChoice:
      return absl::StrCat(title, ":(", absl::StrJoin(option.choices, " "), ")");
    case ValueKind::kFile:
      return title + ":_files";
    case ValueKind::kOther:
      return title + ": ";
  }
  return "";
}

/// One specification for each name of the option.
std::string zsh_option(const OptionHelp& option) {
  std::string specifications;
  for (const std::string& name : option.names) {
    absl::StrAppend(&specifications, "    '", option.repeats ? "*" : "", name, "[",
                    zsh_text(option.about), "]", zsh_value(option), "' \\\n");
  }
  return specifications;
}

std::string zsh_function_of(const CommandHelp& command) {
  return "_" + absl::StrReplaceAll(joined_path(command, "_"), {{"-", "_"}});
}

/// A function for the command, behind those of its own commands.
std::string zsh_function(const CommandHelp& command, const CommandHelp* parent) {
  std::string functions;
  for (const CommandHelp& each : command.commands) functions += zsh_function(each, &command);
  const std::string name = zsh_function_of(command);
  absl::StrAppend(&functions, name, "() {\n  local state line\n  _arguments -C \\\n");
  for (const OptionHelp& option : options_of(command, parent)) functions += zsh_option(option);
  if (command.commands.empty()) {
    return absl::StrCat(
        functions, "    '*:", command.positionals.empty() ? " : " : "file:_files", "'\n}\n\n");
  }
  functions +=
      "    '1: :->command' '*:: :->arguments'\n  case $state in\n    command)\n"
      "      local -a commands=(\n";
  for (const CommandHelp& each : command.commands) {
    absl::StrAppend(&functions, "        '", each.path.back(), ":",
                    absl::StrReplaceAll(each.about, {{"'", "'\\''"}}), "'\n");
  }
  functions +=
      "      )\n      _describe command commands ;;\n    arguments)\n"
      "      case $line[1] in\n";
  for (const CommandHelp& each : command.commands) {
    absl::StrAppend(&functions, "        ", each.path.back(), ") ", zsh_function_of(each),
                    " ;;\n");
  }
  return functions + "      esac ;;\n  esac\n}\n\n";
}

}  // namespace

std::string zsh_completion(const CommandHelp& program) {
  const std::string name = joined_path(program, " ");
  return absl::StrCat("#compdef ", name, "\n# zsh completion for ", name,
                      ", made from its --help.\n\n", zsh_function(program, nullptr),
                      zsh_function_of(program), " \"$@\"\n");
}

}  // namespace tet
