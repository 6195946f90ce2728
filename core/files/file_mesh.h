// A mesh as files have it: of first order, or of second with a node in the middle of each edge.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "core/mesh/faces.h"
#include "core/mesh/tet_mesh.h"
#include "core/second_order/middle_nodes.h"

namespace tet {

/// How many rows the columns of a file have, beside its tets.
struct FileShape {
  std::uint64_t nodes = 0;
  std::size_t nodes_per_tet = 4;  ///< or 10
};

/// A mesh and, where it is of second order, its middle nodes; somebody else holds both. In a
/// file the middle nodes follow the vertices.
struct FileMesh {
  const TetMesh& mesh;
  const MiddleNodes* middles = nullptr;

  FileShape shape() const noexcept;
  /// World coordinates.
  WorldPoint node(std::uint64_t i) const noexcept;
  /// The values of a node's fields, as TetMesh::fields has them; the mesh has some.
  const std::byte* field_row(std::uint64_t i) const noexcept;
  /// A tet's corners, and of a mesh of second order the middles of its edges behind them, in
  /// the order of kTetEdges.
  template <std::size_t kNodes>
  std::array<std::uint64_t, kNodes> nodes_of(std::uint64_t tet) const noexcept;
};

/// Calls `use(number)` with the nodes that each tet of the mesh has, 4 or 10, as a constant.
template <class Use>
void with_nodes_per_tet(const FileMesh& mesh, const Use& use) {
  if (mesh.middles == nullptr) {
    use(std::integral_constant<std::size_t, 4>{});
  } else {
    use(std::integral_constant<std::size_t, 10>{});
  }
}

/// The shape of a mesh of first order.
inline FileShape shape_of(const MeshHeader& mesh) noexcept { return {mesh.vertex_count, 4}; }

inline FileShape FileMesh::shape() const noexcept {
  if (middles == nullptr) return shape_of(mesh.header);
  return {mesh.header.vertex_count + middles->count, 10};
}

inline WorldPoint FileMesh::node(std::uint64_t i) const noexcept {
  if (i < mesh.header.vertex_count) return mesh.vertex(i);
  const auto [x, y, z] = middles->stored_position(mesh.header, i - mesh.header.vertex_count);
  const WorldPoint& origin = mesh.header.origin;
  return {origin.x + x, origin.y + y, origin.z + z};
}

inline const std::byte* FileMesh::field_row(std::uint64_t i) const noexcept {
  const std::uint64_t vertices = mesh.header.vertex_count;
  const std::size_t row_bytes = mesh.header.field_values() * sizeof(float);
  return i < vertices ? mesh.fields.bytes().data() + i * row_bytes
                      : middles->fields.bytes().data() + (i - vertices) * row_bytes;
}

template <std::size_t kNodes>
std::array<std::uint64_t, kNodes> FileMesh::nodes_of(std::uint64_t tet) const noexcept {
  static_assert(kNodes == 4 || kNodes == 10);
  std::array<std::uint64_t, kNodes> nodes;
  const auto corners = mesh.tet(tet);
  for (std::size_t i = 0; i < 4; ++i) nodes[i] = corners[i];
  if constexpr (kNodes == 10) {
    const auto middle = middles->of_tet(tet);
    for (std::size_t e = 0; e < 6; ++e) nodes[4 + e] = mesh.header.vertex_count + middle[e];
  }
  return nodes;
}

/// The edge of a tet between two of its corners, a place in kTetEdges.
constexpr std::size_t tet_edge_between(std::size_t a, std::size_t b) noexcept {
  std::size_t e = 0;
  while (kTetEdges[e] != std::array{a, b} && kTetEdges[e] != std::array{b, a}) ++e;
  return e;
}

/// The three nodes of a face that a tet of four has, or the six that one of ten has: its
/// corners, counter-clockwise seen from outside, and the middles from each to the next.
template <std::size_t kNodes>
auto nodes_of_face(const std::array<std::uint64_t, kNodes>& tet,
                   std::size_t opposite) noexcept {
  const auto& [a, b, c] = kFaceCorners[opposite];
  if constexpr (kNodes == 4) {
    return Triangle{tet[a], tet[b], tet[c]};
  } else {
    return std::array<std::uint64_t, 6>{tet[a],
                                        tet[b],
                                        tet[c],
                                        tet[4 + tet_edge_between(a, b)],
                                        tet[4 + tet_edge_between(b, c)],
                                        tet[4 + tet_edge_between(c, a)]};
  }
}

}  // namespace tet
