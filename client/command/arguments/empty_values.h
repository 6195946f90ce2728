// Options with nothing for a value, as a shell writes them where a variable is not set.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace tet {

/// Has `app` and its commands refuse options and arguments whose value is an empty text: what
/// was to be said is missing, and what the option is for when it is left out may be far from
/// that, as of `--until "$CUTOFF"`. `--grid` takes it, as grids may have no name. Call it when
/// all options are there.
void refuse_empty_values(CLI::App& app);

/// Says that it is `option` to which nothing was given.
std::string no_value_message(const std::string& option);

}  // namespace tet
