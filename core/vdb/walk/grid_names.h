// What the grids of a .vdb file are called, so that each has a name of its own.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace tet {

/// Names as they are stored, unique, to names that are shown and asked for: unique UTF-8 of at
/// most kMaxGridNameBytes.
///
/// "name\x1e2", the third of that name, becomes "name[2]", or the next number where another
/// grid is called so. A name that is not UTF-8 is read as Latin-1. Only a file's single grid
/// keeps an empty name, which means any: among several it becomes "[0]".
std::vector<std::string> shown_names(std::span<const std::string> stored);

}  // namespace tet
