// Zero nodes of a brick where the surface plainly is a manifold: all nodes looked at at once.
#pragma once

#include "core/lattice/bcc.h"
#include "core/stuffing/topology/climb.h"
#include "core/stuffing/topology/nodes_near.h"

namespace tet {

/// Finds own zeros of which `is_plainly_manifold` holds, and that have both `+` and `-` beside
/// them: all of them around which both climb to one (see `all_climb_to_one`), the `+` towards
/// the corner, the `-` away from it.
NodeMasks plain_zeros(const NodesNear& nodes, const BoxCorner& corner) noexcept;

}  // namespace tet
