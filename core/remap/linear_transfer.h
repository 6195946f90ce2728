// What a mesh's tables say at points that lie anywhere.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/cancel.h"
#include "core/remap/columns.h"
#include "core/remap/tet_locator.h"

namespace tet {

/// Points outside a mesh, and how far at most.
struct Outside {
  std::uint64_t points = 0;
  double farthest = 0;
};

/// What corner rows are multiplied by for a value at `p`, which is at `place`: its shares; or,
/// beyond the reach of extrapolation and outside a flat tet, which says nothing there, all of
/// the nearest corner.
CornerShares usable_shares(const TetLocator& locator,
                           const WorldPoint& p,
                           const TetLocator::Place& place) noexcept;

// Both are parallel; once `cancellation` is requested they end soon, and rows are missing.

/// The corners' rows at each point. `clamp` keeps values between those of the corners.
Table sample_at_points(const TetLocator& locator,
                       const Table& corners,
                       const std::vector<WorldPoint>& points,
                       bool clamp,
                       const Cancellation& cancellation,
                       Outside& outside);

/// The row of the cell around each point.
Table sample_cells(const TetLocator& locator,
                   const Table& cells,
                   const std::vector<WorldPoint>& points,
                   const Cancellation& cancellation,
                   Outside& outside);

}  // namespace tet
