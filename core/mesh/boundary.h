// The boundary surface of a mesh and its topology.
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/boundary_topology.h"
#include "core/mesh/faces.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// The boundary triangles, counter-clockwise seen from outside, sorted by their smallest
/// vertex.
std::vector<Triangle> boundary_triangles(const TetMesh& mesh);
/// The boundary triangles of the tets in `region` alone, as if there were no others: the
/// surface, and what of the box's faces the region reaches.
std::vector<Triangle> boundary_triangles(const TetMesh& mesh, MeshRegion region);

/// Topology of triangles whose vertex ids are below `vertex_count`.
BoundaryTopology measure_topology(std::vector<Triangle> triangles, std::uint64_t vertex_count);

BoundaryTopology measure_boundary(const TetMesh& mesh);
/// Measures the boundary of the tets inside alone; where there are no others, of the whole
/// mesh.
BoundaryTopology measure_inside_boundary(const TetMesh& mesh);

}  // namespace tet
