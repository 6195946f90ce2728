// What a command's --help says, as data: manual pages and completions are made of it.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace tet {

/// An option, a flag or a positional argument.
struct OptionHelp {
  std::vector<std::string> names;  ///< "-o", "--output"; the single name of a positional
  std::string value;               ///< stands for the value in --help; empty for a flag
  std::vector<std::string> choices;
  std::string limit;  ///< what else is said of its values: "INT in [1 - 64]"
  std::string about;
  std::string group;        ///< the heading in --help: "Options"
  std::string environment;  ///< the variable that is read in its place; or empty
  std::vector<std::string> excludes;
  bool required = false;
  bool repeats = false;
};

struct CommandHelp {
  std::vector<std::string> path;  ///< "tetstream", "job", "submit"
  std::string about;
  std::string footer;
  std::vector<OptionHelp> positionals;
  std::vector<OptionHelp> options;
  std::vector<CommandHelp> commands;
  bool needs_command = false;
  bool takes_parents_options = false;
};

/// Hidden options and commands are left out.
CommandHelp read_help(CLI::App& app);

/// The names, joined by what stands between them: "tetstream-job-submit".
std::string joined_path(const CommandHelp& command, const std::string& between);

}  // namespace tet
