// The regions on either side of the surface near a brick, which tell its parts.
#pragma once

#include <optional>
#include <vector>

#include "core/stuffing/topology/node_regions.h"

namespace tet {

/// Nodes on one side of the surface that hang together, and those beside them.
struct NodeRegion {
  NodePlanes nodes, beside;
};

/// The signs of nodes, valid for [-1, 8]^3; others are `-`.
struct SignedNodes {
  const NodeSets& plus;
  const NodeSets& zero;
};

/// The regions of a brick's star, inside and not.
///
/// A part of the surface lies between one region of either side, and all that lies between the
/// same two is one part: in a ball, what two connected closed sets that cover it have in common
/// is connected.
struct SurfaceRegions : StarSigns {
  /// Zeros within the inside, as far as can be seen: no boundary is at them. They count as `+`.
  NodePlanes inner;
  std::vector<NodeRegion> inside, others;
  bool too_many = false;  ///< not all of them were found

  explicit SurfaceRegions(const SignedNodes& signs);
  /// One region on either side, the inside with some inner zeros.
  SurfaceRegions(const StarSigns& star, const NodePlanes& inner_zeros);

  /// Whether there is one on either side, and other bricks see it so.
  bool have_one_sheet() const noexcept;
};

/// What SurfaceRegions takes for inner zeros, where the `+` nodes of a star hang together and
/// the `-` nodes do, and it would find one region on either side. `lone` are the zeros that
/// have no `-` of the star beside them. std::nullopt where that is not plain.
std::optional<NodePlanes> find_inner_zeros(const StarSigns& star,
                                           const NodePlanes& lone,
                                           const SignedNodes& signs);

}  // namespace tet
