// What lies on either side of the surface.
#pragma once

#include <cstdint>

#include "core/mesh/tet_mesh.h"

namespace tet {

/// How many tets of a mesh lie in `region`; without regions all of them lie inside.
std::uint64_t count_tets(const TetMesh& mesh, MeshRegion region) noexcept;

/// Volume of the tets in `region`, world units cubed. Measured in parallel; one value for any
/// number of threads.
double measure_volume(const TetMesh& mesh, MeshRegion region);

}  // namespace tet
