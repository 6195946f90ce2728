// Which tets of a finest brick are those that it had in an earlier mesh.
#pragma once

#include <span>

#include "core/base/brick_mask.h"
#include "core/base/types.h"
#include "core/plan/brick/kept_runs.h"
#include "core/stuffing/cell_nodes.h"
#include "core/stuffing/stuffed_brick.h"

namespace tet {

/// What a finest brick's tets follow from, but for where their vertices lie.
struct TetsOfBrick {
  CellNodes nodes;       ///< as the inside sees them
  const FanMasks* fans;  ///< null where there are none
};

/// Passes the tets that a brick had and has, in their order. Those of `kept` cells are the same
/// in both.
void pass_tets(TetsOfBrick& before,
               TetsOfBrick& now,
               const BrickMask& kept,
               std::span<const MeshRegion> regions,
               RunWalk& walk);

/// Leaves a brick only the tets of some of its cells.
void leave_tets_of(const BrickMask& cells, CellNodes& nodes) noexcept;

}  // namespace tet
