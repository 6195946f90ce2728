// A word of a command line that means something else to CLI11 than to whoever wrote it.
#pragma once

#include <string>
#include <vector>

namespace tet {

/// The first of the words that is `--option=` and no more, without its `=`; empty where none
/// is. CLI11 would take the next word for the value, whatever it is. Words after `--` are none
/// of these.
std::string option_without_value(const std::vector<std::string>& words);

}  // namespace tet
