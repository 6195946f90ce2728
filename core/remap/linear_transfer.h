// What a mesh's tables say at points that lie anywhere.
#pragma once

#include <cstdint>
#include <vector>

#include "core/remap/columns.h"
#include "core/remap/tet_locator.h"

namespace tet {

/// Points outside a mesh, and how far at most.
struct Outside {
  std::uint64_t points = 0;
  double farthest = 0;
};

/// What corner rows are multiplied by for a value at `place`: its shares, or those of the
/// nearest corner beyond the reach of extrapolation.
CornerShares usable_shares(const TetLocator& locator, const TetLocator::Place& place) noexcept;

/// The corners' rows at each point. `clamp` keeps values between those of the corners.
/// Parallel.
Table sample_at_points(const TetLocator& locator,
                       const Table& corners,
                       const std::vector<WorldPoint>& points,
                       bool clamp,
                       Outside& outside);

/// The row of the cell around each point. Parallel.
Table sample_cells(const TetLocator& locator,
                   const Table& cells,
                   const std::vector<WorldPoint>& points,
                   Outside& outside);

}  // namespace tet
