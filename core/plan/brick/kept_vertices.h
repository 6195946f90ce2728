// Which vertices of a brick are those that it had in an earlier mesh.
#pragma once

#include <array>

#include "core/base/brick_mask.h"
#include "core/lattice/bcc.h"
#include "core/stuffing/local_vertices.h"

namespace tet {

/// Some of a brick's vertices, but for the middles of surface quads.
struct VertexMasks {
  NodeMasks node;
  std::array<BrickMask, kEdgeFamilies> cut;
};

/// The vertices that a brick owned and owns, and that lie where they lay: nodes on the same
/// side of the surface, or moved alike, and cut points as far along their edges. Bricks at the
/// surface have their geometry.
VertexMasks kept_vertices(const OwnedVertices& before, const OwnedVertices& now) noexcept;

/// Those that a brick owned, or owns, and that are not among `kept`.
VertexMasks changed_vertices(const OwnedVertices& before,
                             const OwnedVertices& now,
                             const VertexMasks& kept) noexcept;

}  // namespace tet
