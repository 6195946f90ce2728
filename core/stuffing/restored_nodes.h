// Nodes that the warp would have moved but that stay where they are, so that the boundary is a
// manifold.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/brick_index.h"
#include "core/base/brick_mask.h"
#include "core/lattice/bcc.h"
#include "core/stuffing/stuffed_lattice.h"
#include "core/stuffing/warp.h"

namespace tet {

/// Restored nodes, by brick.
class RestoredNodes {
 public:
  RestoredNodes() = default;
  /// `bricks` are sorted and unique, `nodes` as many.
  RestoredNodes(std::vector<BrickCoord> bricks, std::vector<NodeMasks> nodes);
  RestoredNodes(RestoredNodes&&) = default;
  RestoredNodes& operator=(RestoredNodes&&) = default;

  std::uint64_t count() const noexcept;
  /// The restored nodes of a brick and its halo.
  std::array<HaloSet, kNodeKinds> around(BrickCoord brick) const noexcept;

 private:
  std::vector<BrickCoord> bricks_;
  std::vector<NodeMasks> nodes_;
  BrickIndex index_;
};

/// Puts nodes back: each takes the sign of its own sample again (`-` if that is exactly zero),
/// and the cut points on its edges, which are too close to it or missing, move to the nearest
/// place that violates nobody. So every tet stays within the bounds that hold for any cut
/// points; the surface is off by at most alpha times an edge there.
void restore_nodes(const std::array<HaloSet, kNodeKinds>& restored,
                   const WarpLimits& limits,
                   StuffedLattice& lattice) noexcept;

}  // namespace tet
