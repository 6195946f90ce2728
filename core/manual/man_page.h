// A command's manual page, in the language of man(7).
#pragma once

#include <string>

#include "core/manual/command_help.h"

namespace tet {

/// What a page says besides the command's own help.
struct ManualEdition {
  std::string section;  ///< "1" for commands, "8" for servers
  std::string version;  ///< "tetstream 0.2.0"
  std::string date;     ///< "2026-11-25"
};

std::string man_page(const CommandHelp& command, const ManualEdition& edition);

}  // namespace tet
