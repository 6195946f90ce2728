// Sets of bricks as sorted lists.
#pragma once

#include <vector>

#include "core/base/types.h"

namespace tet {

/// Sorts bricks and leaves one of each. Takes time in proportion to their number.
void sort_unique(std::vector<BrickCoord>& bricks);

/// The bricks (sorted, unique) and the 26 around each, `step` bricks away along an axis;
/// sorted, unique. Takes time in proportion to both numbers.
std::vector<BrickCoord> with_neighbours(const std::vector<BrickCoord>& bricks, int step = 1);

}  // namespace tet
