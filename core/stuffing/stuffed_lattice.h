// The geometry of a brick near the surface: what its samples decide.
#pragma once

#include "core/base/types.h"
#include "core/lattice/bcc.h"
#include "core/stuffing/cut_points.h"
#include "core/stuffing/warp.h"

namespace tet {

/// Cut points and warps of a brick, found anew whenever they are needed.
struct StuffedLattice {
  CutPoints cuts;
  WarpedLattice warped;

  /// Where a node or a cut point lies, in units of the spacing from the brick's lowest corner.
  WorldPoint place_of_node(NodeKind kind, int index) const noexcept;
  WorldPoint place_of_cut(int family, int index) const noexcept;
};

/// Where a node of an unmoved lattice lies.
WorldPoint lattice_place(NodeKind kind, int index) noexcept;

}  // namespace tet
