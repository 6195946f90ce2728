// Sets of bricks as sorted lists.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "core/base/cancel.h"
#include "core/base/types.h"

namespace tet {

/// Bricks that are gone through between two looks at a cancellation: about a millisecond's.
inline constexpr std::size_t kBricksPerLook = std::size_t{1} << 16;

/// Sorts bricks and leaves one of each. Takes time in proportion to their number. Once
/// cancelled they are in no order, and of no use.
void sort_unique(std::vector<BrickCoord>& bricks, const Cancellation& cancellation = {});

/// The bricks (sorted, unique) and the 26 around each, `step` bricks away along an axis;
/// sorted, unique. Takes time in proportion to both numbers. Some of them where they are more
/// than `most`: then more than that, and no more than three times as many.
std::vector<BrickCoord> with_neighbours(
    const std::vector<BrickCoord>& bricks,
    int step = 1,
    std::size_t most = std::numeric_limits<std::size_t>::max());

}  // namespace tet
