// The geometry of a brick near the surface: what its samples decide.
#pragma once

#include <cstddef>

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

/// The point at a fraction of the edge that node `low` owns in `direction`.
WorldPoint place_on_edge(LatticeCoord low, int direction, float fraction) noexcept;
/// Where a node lies that moved in `direction` (0..13) onto a cut point: `fraction` is that
/// point's, from its edge's lower node.
WorldPoint place_of_moved(LatticeCoord node, int direction, float fraction) noexcept;

// In the header because they are called for every vertex at the surface.

inline WorldPoint lattice_place(NodeKind kind, int index) noexcept {
  const LatticeCoord at = node_coord(kind, index);
  return {0.5 * at.x, 0.5 * at.y, 0.5 * at.z};
}

inline WorldPoint place_on_edge(LatticeCoord low, int direction, float fraction) noexcept {
  const LatticeCoord along = kDirection[static_cast<std::size_t>(direction)];
  const double t = 0.5 * static_cast<double>(fraction);
  return {0.5 * low.x + t * along.x, 0.5 * low.y + t * along.y, 0.5 * low.z + t * along.z};
}

inline WorldPoint place_of_moved(LatticeCoord node, int direction, float fraction) noexcept {
  // The edge's lower node owns the cut point: seen from either end it is the same place.
  if (direction < kOwnedDirections) return place_on_edge(node, direction, fraction);
  const LatticeCoord low = node + kDirection[static_cast<std::size_t>(direction)];
  return place_on_edge(low, opposite(direction), fraction);
}

inline WorldPoint StuffedLattice::place_of_cut(int family, int index) const noexcept {
  return place_on_edge(
      node_coord(family_kind(family), index), family_direction(family),
      cuts.fraction[static_cast<std::size_t>(family)][static_cast<std::size_t>(index)]);
}

inline WorldPoint StuffedLattice::place_of_node(NodeKind kind, int index) const noexcept {
  if (!warped.warped[kind].test(index)) return lattice_place(kind, index);
  // The edge's lower node owns the cut point: seen from either end it is the same place.
  const int direction = warped.direction[kind][static_cast<std::size_t>(index)];
  if (direction < kOwnedDirections) return place_of_cut(edge_family(kind, direction), index);
  return place_of_cut(edge_family(end_kind(kind, direction), opposite(direction)),
                      index + end_offset(kind, direction));
}

}  // namespace tet
