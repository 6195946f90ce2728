#include "core/manual/command_help.h"

#include <CLI/CLI.hpp>
#include <absl/strings/str_join.h>
#include <absl/strings/str_split.h>
#include <absl/strings/strip.h>

namespace tet {
namespace {

/// The descriptions of an option's validators, which CLI11 appends to the name of its type.
std::vector<std::string> read_limits(CLI::Option& option) {
  std::vector<std::string> limits;
  try {
    for (int i = 0;; ++i) limits.push_back(option.get_validator(i)->get_description());
  } catch (const CLI::OptionNotFound&) {
    return limits;  // CLI11 has no other way to count them
  }
}

std::string type_without(const std::vector<std::string>& limits, std::string type) {
  for (auto limit = limits.rbegin(); limit != limits.rend(); ++limit) {
    if (!limit->empty()) type = std::string(absl::StripSuffix(type, ":" + *limit));
  }
  return type;
}

/// CLI11 describes a set of words as "{a,b,c}".
void read_values(CLI::Option& option, OptionHelp& help) {
  const std::vector<std::string> limits = read_limits(option);
  help.value = type_without(limits, option.get_type_name());
  for (const std::string& limit : limits) {
    if (limit.size() > 2 && limit.front() == '{' && limit.back() == '}') {
      help.choices = absl::StrSplit(limit.substr(1, limit.size() - 2), ',');
    } else if (!limit.empty()) {
      help.limit = limit;
    }
  }
}

std::vector<std::string> names_of(const CLI::Option& option) {
  if (option.get_positional()) return {option.get_name(true)};
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  return names;
}

OptionHelp read_option(CLI::Option& option) {
  OptionHelp help;
  help.names = names_of(option);
  if (option.get_type_size() != 0) read_values(option, help);
  help.about = option.get_description();
  help.group = option.get_group();
  help.environment = option.get_envname();
  for (const CLI::Option* other : option.get_excludes()) {
    help.excludes.push_back(other->get_name());
  }
  help.required = option.get_required();
  help.repeats = option.get_expected_max() == CLI::detail::expected_max_vector_size;
  return help;
}

CommandHelp read_command(CLI::App& app, std::vector<std::string> path) {
  CommandHelp help;
  help.path = std::move(path);
  help.path.push_back(app.get_name());
  help.about = app.get_description();
  help.footer = app.get_footer();
  help.needs_command = app.get_require_subcommand_min() > 0;
  help.takes_parents_options = app.get_fallthrough();
  for (CLI::Option* option : app.get_options()) {
    if (option->get_group().empty()) continue;
    (option->get_positional() ? help.positionals : help.options)
        .push_back(read_option(*option));
  }
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; })) {
    if (!command->get_group().empty())
      help.commands.push_back(read_command(*command, help.path));
  }
  return help;
}

}  // namespace

CommandHelp read_help(CLI::App& app) { return read_command(app, {}); }

std::string joined_path(const CommandHelp& command, const std::string& between) {
  return absl::StrJoin(command.path, between);
}

}  // namespace tet
