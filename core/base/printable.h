// Text of others where people see it: names from files and servers may hold anything.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace tet {

/// `text` cut to `limit` bytes, with anything but printable ASCII as '?'.
std::string printable(std::string_view text, std::size_t limit);

/// `text` as a terminal may have it, in one line: printable characters as they are, in any
/// language; what would move the cursor, begin a command to the terminal, turn the direction of
/// writing or is no UTF-8 as \n, \x1b or \u202e.
std::string for_terminal(std::string_view text);

/// Does so with several lines, which stay apart.
std::string lines_for_terminal(std::string_view text);

}  // namespace tet
