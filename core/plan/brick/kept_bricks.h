// Which bricks of a mesh are those of an earlier one.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/brick_index.h"

namespace tet {

inline constexpr std::uint32_t kNewBrick = kNoBrick;

/// Where each brick of a level is in the earlier mesh's level, kNewBrick where it is not.
using BrickPlaces = std::vector<std::uint32_t>;

/// Says for each brick of a level which brick of the earlier mesh's level has its vertices, or
/// its tets: kNewBrick where none has.
///
/// Where a brick is not kept, `nodes` says which brick it was: what neither moved to the
/// surface has some of its nodes as it had them.
struct KeptBricks {
  BrickPlaces vertices, tets, nodes;
};

}  // namespace tet
