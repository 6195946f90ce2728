#include <vector>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_join.h>
#include <absl/strings/str_replace.h>
#include <absl/strings/substitute.h>

#include "core/manual/completion.h"

namespace tet {
namespace {

// $0 the function, $1 the program, $2 cases of commands, $3 of values, $4 of words.
constexpr const char* kBashScript = R"(# bash completion for $1, made from its --help.
$0() {
  local word=$${COMP_WORDS[COMP_CWORD]} previous=$${COMP_WORDS[COMP_CWORD-1]}
  local command=$1 options='' words='' files='' i
  # bash takes --option=value apart at the equals sign.
  if [[ $$word == '=' ]]; then
    word=''
  elif [[ $$previous == '=' ]]; then
    previous=$${COMP_WORDS[COMP_CWORD-2]}
  fi
  for ((i = 1; i < COMP_CWORD; ++i)); do
    case "$$command $${COMP_WORDS[i]}" in
$2      *) ;;
    esac
  done
  COMPREPLY=()
  case "$$command $$previous" in
$3    *)
      case "$$command" in
$4      esac
      if [[ $$word == -* ]]; then
        words=$$options files=''
      fi ;;
  esac
  mapfile -t COMPREPLY < <(compgen -W "$$words" -- "$$word")
  if [[ -n $$files ]]; then
    compopt -o filenames
    mapfile -t -O "$${#COMPREPLY[@]}" COMPREPLY < <(compgen -f -- "$$word")
  fi
}
complete -F $0 $1
)";

struct BashCases {
  std::string commands, values, words;
};

std::string value_case(const std::string& path, const OptionHelp& option) {
  std::vector<std::string> patterns;
  for (const std::string& name : option.names) {
    patterns.push_back(absl::StrCat("'", path, " ", name, "'"));
  }
  std::string action;
  if (!option.choices.empty()) {
    action = absl::StrCat(" words='", absl::StrJoin(option.choices, " "), "'");
  } else if (kind_of_value(option) == ValueKind::kFile) {
    action = " files=1";
  }
  return absl::StrCat("    ", absl::StrJoin(patterns, " | "), ")", action, " ;;\n");
}

/// Arguments that have no dash in front are commands where there are any, else files.
std::string word_case(const std::string& path,
                      const CommandHelp& command,
                      const std::vector<OptionHelp>& options) {
  std::vector<std::string> names, commands;
  for (const OptionHelp& option : options) {
    names.insert(names.end(), option.names.begin(), option.names.end());
  }
  for (const CommandHelp& each : command.commands) commands.push_back(each.path.back());
  return absl::StrCat("        '", path, "') options='", absl::StrJoin(names, " "), "' words='",
                      absl::StrJoin(commands, " "), "'",
                      command.positionals.empty() ? "" : " files=1", " ;;\n");
}

void add_bash_cases(const CommandHelp& command, const CommandHelp* parent, BashCases& cases) {
  const std::string path = joined_path(command, " ");
  if (parent != nullptr) {
    absl::StrAppend(&cases.commands, "      '", path, "') command='", path, "' ;;\n");
  }
  const std::vector<OptionHelp> options = options_of(command, parent);
  for (const OptionHelp& option : options) {
    if (!option.value.empty()) cases.values += value_case(path, option);
  }
  cases.words += word_case(path, command, options);
  for (const CommandHelp& each : command.commands) add_bash_cases(each, &command, cases);
}

}  // namespace

std::string bash_completion(const CommandHelp& program) {
  BashCases cases;
  add_bash_cases(program, nullptr, cases);
  const std::string name = joined_path(program, " ");
  const std::string function = "_" + absl::StrReplaceAll(name, {{"-", "_"}});
  return absl::Substitute(kBashScript, function, name, cases.commands, cases.values,
                          cases.words);
}

}  // namespace tet
