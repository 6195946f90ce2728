// Writes a program's manual pages and completions when it is built.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace tet {

/// Adds `--write-manual DIRECTORY`, which --help does not show: writes the manual page of the
/// program and of each command of it to `DIRECTORY/man`, and completions to `bash`, `zsh` and
/// `fish` beside it; then ends the parsing as --help does. The date of the pages comes from the
/// variable TETSTREAM_MANUAL_DATE. `app` must have all its options by the time it parses.
void add_manual_option(CLI::App& app, const std::string& section, const std::string& version);

}  // namespace tet
