// How many tets of a mesh a task takes at once, where each is looked at alone.
#pragma once

#include <cstddef>

namespace tet {

inline constexpr std::size_t kTetsPerRange = 16384;

}  // namespace tet
