// The faces of the lattice's tets, each owned by its lowest node: where three labels meet, a
// face has a vertex in its middle.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/lattice/bcc.h"

namespace tet {

/// The node of a tet beside a face that the face does not have.
struct OppositeNode {
  NodeKind kind{};
  LatticeCoord step;  ///< from the face's lowest node, doubled
  int to_node = 0;    ///< the same by halo index
};

/// All faces that nodes of one kind own with the same two steps to their other nodes; 24 such
/// families hold every face of the lattice once.
struct FaceFamily {
  std::array<NodeKind, 3> kind{};
  std::array<LatticeCoord, 3> step{};  ///< doubled coordinates from the lowest node, ascending
  std::array<int, 3> to_node{};        ///< the same by halo index
  std::array<OppositeNode, 2> opposite{};
  /// Edges 01, 12, 02 in this order, which is the order in which their cut points are summed.
  std::array<std::uint8_t, 3> edge_family{};
};

inline constexpr int kFaceFamilies = 24;
inline constexpr std::size_t kTetFaces = 4;
/// The ends of a face's edges, in the order of FaceFamily::edge_family.
inline constexpr std::array<std::array<std::uint8_t, 2>, 3> kFaceEdge{{{0, 1}, {1, 2}, {0, 2}}};

/// The nodes of a tet's face opposite to node i, ascending.
constexpr std::array<std::uint8_t, 3> nodes_of_face(std::size_t i) noexcept {
  std::array<std::uint8_t, 3> nodes{};
  std::size_t next = 0;
  for (std::uint8_t node = 0; node < 4; ++node) {
    if (node != i) nodes[next++] = node;
  }
  return nodes;
}

namespace internal {

struct FaceTables {
  std::array<FaceFamily, kFaceFamilies> family{};
  std::array<std::array<std::uint8_t, kTetFaces>, kTetShapes> of_shape{};
  int count = 0;
};

constexpr FaceFamily family_of_face(const TetShape& shape, std::size_t opposite_node) {
  const auto node = nodes_of_face(opposite_node);
  const auto at = [&](std::size_t i) {
    return node_coord(shape.kind[node[i]], halo_index(0, 0, 0) + shape.offset[node[i]]);
  };
  FaceFamily family;
  for (std::size_t i = 0; i < 3; ++i) {
    family.kind[i] = shape.kind[node[i]];
    family.step[i] = at(i) - at(0);
    family.to_node[i] = shape.offset[node[i]] - shape.offset[node[0]];
    family.edge_family[i] = family_between(at(kFaceEdge[i][0]), at(kFaceEdge[i][1]));
  }
  return family;
}

constexpr OppositeNode opposite_node(const TetShape& shape, std::size_t node) {
  const auto low = nodes_of_face(node)[0];
  const auto at = [&](std::size_t i) {
    return node_coord(shape.kind[i], halo_index(0, 0, 0) + shape.offset[i]);
  };
  return {shape.kind[node], at(node) - at(low), shape.offset[node] - shape.offset[low]};
}

constexpr FaceTables make_face_tables() {
  FaceTables tables;
  for (std::size_t shape = 0; shape < kTetShapes; ++shape) {
    for (std::size_t i = 0; i < kTetFaces; ++i) {
      const FaceFamily family = family_of_face(kTetShape[shape], i);
      int known = 0, found = -1;
      for (; known < tables.count; ++known) {
        const FaceFamily& other = tables.family[static_cast<std::size_t>(known)];
        if (other.kind == family.kind && other.step == family.step) {
          found = known;
          break;
        }
      }
      if (known == tables.count) {
        tables.family[static_cast<std::size_t>(tables.count++)] = family;
      }
      tables.of_shape[shape][i] = static_cast<std::uint8_t>(known);
      OppositeNode& beyond =
          tables.family[static_cast<std::size_t>(known)].opposite[found == known ? 1 : 0];
      beyond = opposite_node(kTetShape[shape], i);
    }
  }
  return tables;
}

inline constexpr FaceTables kFaceTables = make_face_tables();
static_assert(kFaceTables.count == kFaceFamilies,
              "12 tets a cell with 4 faces each, of which each belongs to two");

}  // namespace internal

inline constexpr auto& kFaceFamily = internal::kFaceTables.family;
/// The family of a shape's face opposite to each of its nodes.
inline constexpr auto& kFaceOfShape = internal::kFaceTables.of_shape;

}  // namespace tet
