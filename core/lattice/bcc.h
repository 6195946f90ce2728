// The body centred cubic lattice: two interleaved grids of nodes, 14 edges a node, 12 tets a
// cell.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>

#include "core/base/brick_mask.h"

namespace tet {

/// Leaves of a brick and of the seven beyond its lower faces, edges and corner, at
/// 4*x + 2*y + z.
using LowerLeaves = std::array<const BrickMask*, 8>;

/// Which of the two grids a node belongs to. In doubled coordinates corners are all even and
/// centres all odd: corner (x, y, z) is at (2x, 2y, 2z), centre (x, y, z) at (2x+1, 2y+1,
/// 2z+1).
enum NodeKind : std::uint8_t { kCorner = 0, kCentre = 1 };
inline constexpr int kNodeKinds = 2;

/// Some of a brick's own nodes, by kind.
using NodeMasks = std::array<BrickMask, kNodeKinds>;

/// Doubled lattice coordinates, or an offset between two of them.
struct LatticeCoord {
  std::int32_t x = 0, y = 0, z = 0;
  friend constexpr auto operator<=>(const LatticeCoord&, const LatticeCoord&) = default;
  friend constexpr LatticeCoord operator+(LatticeCoord a, LatticeCoord b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  friend constexpr LatticeCoord operator-(LatticeCoord a, LatticeCoord b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
};

/// The 14 edges of a node: 6 long (two units along an axis) and 8 short. A node owns the first
/// seven, which lead to nodes higher in the order of coordinates; direction d + 7 is opposite
/// to d.
inline constexpr int kDirections = 14;
inline constexpr int kOwnedDirections = 7;
inline constexpr std::array<LatticeCoord, kDirections> kDirection{{
    {2, 0, 0},
    {0, 2, 0},
    {0, 0, 2},
    {1, -1, -1},
    {1, -1, 1},
    {1, 1, -1},
    {1, 1, 1},
    {-2, 0, 0},
    {0, -2, 0},
    {0, 0, -2},
    {-1, 1, 1},
    {-1, 1, -1},
    {-1, -1, 1},
    {-1, -1, -1},
}};
constexpr bool is_long(int direction) noexcept { return direction % kOwnedDirections < 3; }
/// Lengths of edges in units of the spacing.
inline constexpr float kLongLength = 1;
inline constexpr float kShortLength = static_cast<float>(std::numbers::sqrt3 / 2);
constexpr int opposite(int direction) noexcept {
  return (direction + kOwnedDirections) % kDirections;
}

constexpr NodeKind kind_of(LatticeCoord node) noexcept {
  return node.x & 1 ? kCentre : kCorner;
}

/// The kind of the node at the end of `direction`.
constexpr NodeKind end_kind(NodeKind kind, int direction) noexcept {
  return is_long(direction) ? kind : static_cast<NodeKind>(1 - kind);
}

/// Halo index of a node; doubled coordinates relative to the brick's lowest corner.
constexpr int node_index(LatticeCoord node) noexcept {
  // Shifting right rounds down, which drops a centre's half.
  return halo_index(node.x >> 1, node.y >> 1, node.z >> 1);
}
constexpr LatticeCoord node_coord(NodeKind kind, int index) noexcept {
  return {2 * ((index >> 8) - 2) + kind, 2 * ((index >> 4 & 15) - 2) + kind,
          2 * ((index & 15) - 2) + kind};
}

/// From a node's cell to that of the node at the end of `direction`: each -1, 0 or 1.
constexpr LatticeCoord end_step(NodeKind kind, int direction) noexcept {
  const LatticeCoord to = kDirection[static_cast<std::size_t>(direction)];
  // Shifting right rounds down, which drops a centre's half.
  return {(kind + to.x) >> 1, (kind + to.y) >> 1, (kind + to.z) >> 1};
}
/// From a node's halo index to that of the node at the end of `direction`.
constexpr int end_offset(NodeKind kind, int direction) noexcept {
  const LatticeCoord step = end_step(kind, direction);
  return offset_index(step.x, step.y, step.z);
}

/// Says for each of the brick's own nodes whether the node a step on from it is in the set.
inline BrickMask brick_part(const HaloSet& nodes, LatticeCoord step) noexcept {
  return brick_part(nodes, step.x, step.y, step.z);
}

/// The nodes of the brick itself, of either kind.
inline constexpr HaloSet kOwnNodes = halo_cube(0, 7);
/// The cells of a brick itself.
inline constexpr HaloSet kOwnCells = halo_cube(0, 7);

/// An edge family: all edges that nodes of one kind own in one direction. 14 of them hold every
/// edge of the lattice once.
inline constexpr int kEdgeFamilies = kNodeKinds * kOwnedDirections;
constexpr int edge_family(NodeKind kind, int owned_direction) noexcept {
  return kind * kOwnedDirections + owned_direction;
}
constexpr NodeKind family_kind(int family) noexcept {
  return static_cast<NodeKind>(family / kOwnedDirections);
}
constexpr int family_direction(int family) noexcept { return family % kOwnedDirections; }

/// One of the 12 shapes in which a cell's tets lie: around each of the cell's three upper
/// faces, the four tets between the two centres and an edge of the face.
///
/// Nodes are in the order of coordinates, so the lower of two is the one that comes first;
/// where that order makes the tet negative, `negative` says so. Offsets are from the cell's
/// halo index.
struct TetShape {
  std::array<NodeKind, 4> kind{};
  std::array<std::int16_t, 4> offset{};
  std::array<std::uint8_t, 6> edge_family{};  ///< of edges 01, 02, 03, 12, 13, 23
  /// Which of the six nodes around the face each is: 0 and 1 are the centres before and behind
  /// it, 2 + turn its corners.
  std::array<std::uint8_t, 4> face_node{};
  bool negative = false;
};

inline constexpr int kTetShapes = 12;
inline constexpr std::size_t kFaceNodes = 6;
inline constexpr std::array<std::array<std::uint8_t, 2>, 6> kTetEdge{
    {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};

namespace internal {

constexpr std::int64_t triple_product(LatticeCoord a, LatticeCoord b, LatticeCoord c) {
  return std::int64_t{a.x} * (b.y * c.z - b.z * c.y) -
         std::int64_t{a.y} * (b.x * c.z - b.z * c.x) +
         std::int64_t{a.z} * (b.x * c.y - b.y * c.x);
}

constexpr std::uint8_t family_between(LatticeCoord low, LatticeCoord high) {
  for (int d = 0; d < kOwnedDirections; ++d) {
    if (kDirection[static_cast<std::size_t>(d)] == high - low) {
      return static_cast<std::uint8_t>(edge_family(kind_of(low), d));
    }
  }
  return 255;
}

constexpr TetShape shape_of(std::array<LatticeCoord, 4> node, int edge) {
  const std::array<LatticeCoord, 4> around_face = node;
  std::sort(node.begin(), node.end());
  TetShape shape;
  for (std::size_t i = 0; i < 4; ++i) {
    shape.kind[i] = kind_of(node[i]);
    const auto given = static_cast<std::size_t>(
        std::find(around_face.begin(), around_face.end(), node[i]) - around_face.begin());
    shape.face_node[i] = static_cast<std::uint8_t>(
        given < 2 ? given : 2 + (static_cast<std::size_t>(edge) + given - 2) % 4);
    shape.offset[i] = static_cast<std::int16_t>(node_index(node[i]) - halo_index(0, 0, 0));
  }
  for (std::size_t e = 0; e < 6; ++e) {
    shape.edge_family[e] = family_between(node[kTetEdge[e][0]], node[kTetEdge[e][1]]);
  }
  shape.negative = triple_product(node[1] - node[0], node[2] - node[0], node[3] - node[0]) < 0;
  return shape;
}

/// Corners of a cell's upper face across `axis`, around it; `turn` counts them.
constexpr LatticeCoord face_corner(int axis, int turn) {
  const std::int32_t u = (turn & 3) == 1 || (turn & 3) == 2 ? 2 : 0;
  const std::int32_t v = (turn & 3) >= 2 ? 2 : 0;
  std::array<std::int32_t, 3> at{};
  at[static_cast<std::size_t>(axis)] = 2;
  at[static_cast<std::size_t>((axis + 1) % 3)] = u;
  at[static_cast<std::size_t>((axis + 2) % 3)] = v;
  return {at[0], at[1], at[2]};
}

constexpr std::array<TetShape, kTetShapes> make_tet_shapes() {
  std::array<TetShape, kTetShapes> shapes;
  constexpr LatticeCoord kCellCentre{1, 1, 1};
  for (int axis = 0; axis < 3; ++axis) {
    for (int edge = 0; edge < 4; ++edge) {
      shapes[static_cast<std::size_t>(axis * 4 + edge)] =
          shape_of({kCellCentre, kCellCentre + kDirection[static_cast<std::size_t>(axis)],
                    face_corner(axis, edge), face_corner(axis, edge + 1)},
                   edge);
    }
  }
  return shapes;
}

}  // namespace internal

/// Shapes 4a .. 4a+3 lie around the cell's upper face across axis a.
inline constexpr std::array<TetShape, kTetShapes> kTetShape = internal::make_tet_shapes();

/// The four shapes around a cell's upper face across an axis.
constexpr std::span<const TetShape, 4> shapes_across(int axis) noexcept {
  return std::span(kTetShape).subspan(static_cast<std::size_t>(axis) * 4).first<4>();
}

static_assert(
    [] {
      for (const TetShape& shape : kTetShape) {
        for (const std::uint8_t family : shape.edge_family) {
          if (family >= kEdgeFamilies) return false;
        }
      }
      return true;
    }(),
    "every edge of a tet is an edge of the lattice, owned by its lower node");

}  // namespace tet
