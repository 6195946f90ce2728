// Scripts by which a shell completes a program's commands, options and their values.
#pragma once

#include <string>

#include "core/manual/command_help.h"

namespace tet {

std::string bash_completion(const CommandHelp& program);
std::string zsh_completion(const CommandHelp& program);
std::string fish_completion(const CommandHelp& program);

/// What can be typed for an option's value.
enum class ValueKind { kNone, kChoice, kFile, kOther };
ValueKind kind_of_value(const OptionHelp& option);

/// The options that a command takes: its own, and its parent's where it passes these on.
std::vector<OptionHelp> options_of(const CommandHelp& command, const CommandHelp* parent);

}  // namespace tet
