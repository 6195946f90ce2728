// How the triangles of a surface meet: is it closed?
#pragma once

#include <cstdint>

#include "core/surface/triangle_surface.h"

namespace tet {

struct SurfaceEdges {
  std::uint64_t open = 0;          ///< of one triangle only
  std::uint64_t non_manifold = 0;  ///< of three or more
};

/// Vertices of equal coordinates count as one, and triangles with two such corners as none.
SurfaceEdges count_edges(const TriangleSurface& surface);

}  // namespace tet
