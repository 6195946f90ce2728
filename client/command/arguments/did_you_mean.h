// What somebody who misspelt a command may have meant.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace tet {

/// Says that a word stands where a command was expected, and which command is spelt nearly so;
/// empty where none does. `app` has parsed a command line, and failed.
std::string unknown_command(const CLI::App& app);

}  // namespace tet
