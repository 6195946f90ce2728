// Sets of the nodes in and around a brick, plane by plane, and the regions that they fall into.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/brick_mask.h"
#include "core/lattice/bcc.h"

namespace tet {

/// A set of nodes of each kind.
using NodeSets = std::array<HaloSet, kNodeKinds>;

/// The star of a brick: its own nodes and all that share an edge with one. The tets between
/// them are a ball, and each edge and face of theirs is in one: so a surface that does not end
/// within it parts it in regions like a ball.
inline constexpr NodeSets kBrickStar = [] {
  NodeSets star{kOwnNodes, kOwnNodes};
  for (const NodeKind kind : {kCorner, kCentre}) {
    for (int d = 0; d < kDirections; ++d) {
      star[end_kind(kind, d)] |= seen_from(kOwnNodes, -end_offset(kind, d));
    }
  }
  return star;
}();

/// The nodes of one kind with the same x: 16 rows of 16 bits, y and z from -2 on, as in a
/// HaloSet. The box has none in the first row nor in the last ones.
struct NodePlane {
  static constexpr std::size_t kWords = 4;
  std::array<std::uint64_t, kWords> word{};

  friend bool operator==(const NodePlane&, const NodePlane&) = default;
};

/// A set of nodes of the box, as planes in the order of x: corners, then centres half a spacing
/// further.
struct NodePlanes {
  static constexpr int kMin = -1, kMax = 8;
  static constexpr std::size_t kPlanes = 2 * (kMax - kMin + 1);
  std::array<NodePlane, kPlanes> plane{};

  NodePlanes() noexcept = default;
  /// `nodes` has nodes of the box only.
  explicit NodePlanes(const NodeSets& nodes) noexcept;
  /// Keeps those of some nodes that are in the brick's star.
  static NodePlanes in_star(const NodeSets& nodes) noexcept;
  NodeSets sets() const noexcept;

  const NodePlane& of(NodeKind kind, int x) const noexcept {
    return plane[static_cast<std::size_t>(2 * (x - kMin) + kind)];
  }
  bool any() const noexcept;

  NodePlanes& operator|=(const NodePlanes& o) noexcept;
  NodePlanes& operator&=(const NodePlanes& o) noexcept;
  /// Takes the nodes of `o` away.
  NodePlanes& operator-=(const NodePlanes& o) noexcept;
  friend NodePlanes operator|(NodePlanes a, const NodePlanes& b) noexcept { return a |= b; }
  friend NodePlanes operator&(NodePlanes a, const NodePlanes& b) noexcept { return a &= b; }
  friend NodePlanes operator-(NodePlanes a, const NodePlanes& b) noexcept { return a -= b; }
  friend bool operator==(const NodePlanes&, const NodePlanes&) = default;
};

bool meet(const NodePlanes& a, const NodePlanes& b) noexcept;

/// The nodes of a brick's star by their signs.
struct StarSigns {
  NodePlanes plus, zero, minus;

  /// The signs of nodes are valid for [-1, 8]^3; others are `-`.
  StarSigns(const NodeSets& all_plus, const NodeSets& all_zero) noexcept;
};

/// Zeros of the star without a `-` of it beside them.
NodePlanes lone_zeros(const StarSigns& star) noexcept;

/// The nodes of the box with an edge to one of these; some of them may be of these.
NodePlanes nodes_beside(const NodePlanes& nodes) noexcept;

/// The first of some nodes, and those that edges within the set connect to it; no edge between
/// two of `zero` is followed. Empty when there is no node.
NodePlanes first_region(const NodePlanes& nodes, const NodePlanes& zero) noexcept;

}  // namespace tet
