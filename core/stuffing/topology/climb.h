// Whether nodes near a brick hang together, told in one pass where they plainly do.
#pragma once

#include "core/stuffing/topology/node_regions.h"

namespace tet {

/// A corner of the box of NodePlanes; each coordinate is 1 at the upper end, or -1.
struct BoxCorner {
  int x = 1, y = 1, z = 1;

  BoxCorner opposite() const noexcept { return {-x, -y, -z}; }
};

/// Where most of some nodes are.
BoxCorner corner_with_most(const NodePlanes& nodes) noexcept;
BoxCorner corner_with_most(const BrickMask& nodes) noexcept;

/// True only where some nodes hang together: from each of them but one an edge leads to another
/// that is nearer to the corner, by x, y and z together. So all paths that go on nearer end at
/// that one. Quicker than to follow the edges from node to node, and true of what is on one
/// side of nearly every smooth surface, where the corner is on the same side.
bool all_climb_to_one(const NodePlanes& nodes, const BoxCorner& corner) noexcept;

}  // namespace tet
