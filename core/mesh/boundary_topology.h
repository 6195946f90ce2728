// The topology of a mesh's boundary.
#pragma once

#include <cstdint>

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

}  // namespace tet
