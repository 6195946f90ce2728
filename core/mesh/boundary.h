// The boundary surface of a mesh and its topology.
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/faces.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// Topology of the boundary: the triangles that belong to one tet only.
struct BoundaryTopology {
  std::uint64_t triangles = 0;
  std::uint64_t vertices = 0;
  std::uint64_t components = 0;             ///< connected through shared vertices
  std::int64_t euler_characteristic = 0;    ///< V - E + F over all components
  std::uint64_t non_manifold_edges = 0;     ///< edges not shared by exactly two triangles
  std::uint64_t non_manifold_vertices = 0;  ///< triangles around it are not one cycle
  /// Nodes that were put back to make it a manifold, where that was asked for.
  std::uint64_t restored_nodes = 0;

  friend bool operator==(const BoundaryTopology&, const BoundaryTopology&) = default;
};

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
