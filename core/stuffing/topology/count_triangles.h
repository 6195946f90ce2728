// How many triangles the boundary of the inside has in a brick: 64 cells at once.
#pragma once

#include <cstdint>

#include "core/stuffing/topology/nodes_near.h"

namespace tet {

/// Counts the triangles of the surface in the tets of a brick's own cells: those within cut
/// tets, and faces of three zeros whose tet is inside, where the tet behind them is not.
std::uint64_t count_triangles(const NodesNear& nodes) noexcept;

}  // namespace tet
