// The regions on either side of the surface near a brick, which tell its parts.
#pragma once

#include <vector>

#include "core/stuffing/node_regions.h"
#include "core/stuffing/warp.h"

namespace tet {

/// Nodes on one side of the surface that hang together, and those beside them.
struct NodeRegion {
  NodePlanes nodes, beside;
};

/// The regions of a brick's star, inside and not.
///
/// A part of the surface lies between one region of either side, and all that lies between the
/// same two is one part: in a ball, what two connected closed sets that cover it have in common
/// is connected.
struct SurfaceRegions {
  NodePlanes plus, zero, minus;
  /// Zeros within the inside, as far as can be seen: no boundary is at them. They count as `+`.
  NodePlanes inner;
  std::vector<NodeRegion> inside, others;
  bool too_many = false;  ///< not all of them were found

  explicit SurfaceRegions(const WarpedLattice& lattice);

  /// Whether there is one on either side, and other bricks see it so.
  bool have_one_sheet() const noexcept;
};

}  // namespace tet
