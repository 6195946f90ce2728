// The triangles of a mesh that stand for the zero surface of phi.
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/faces.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// What a mesh of the inside ends at, and what lies between the inside and the outside of a
/// mesh of both sides; the faces of a box are left out. Counter-clockwise seen from outside,
/// sorted by their smallest vertex.
std::vector<Triangle> surface_triangles(const TetMesh& mesh);

/// The faces of the box that a vertex lies in, as the bits of CutFaces; 0 where no box cuts the
/// mesh.
std::uint32_t box_faces_at(const TetMesh& mesh, std::uint64_t vertex) noexcept;

}  // namespace tet
