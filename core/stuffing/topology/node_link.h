// The link of a lattice node: its 14 neighbours on a sphere around it, and what their signs say
// of the surface at the node.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/brick_mask.h"
#include "core/lattice/bcc.h"

namespace tet {

/// One bit for each direction of a node.
using DirectionSet = std::uint16_t;
inline constexpr DirectionSet kAllDirections = (1U << kDirections) - 1;

/// Signs of the neighbours of a node that is zero.
struct NodeLink {
  DirectionSet plus = 0, zero = 0;
};

/// The surface at a zero node.
struct SurfaceAtNode {
  bool on_surface = false;  ///< some boundary triangle has the node
  bool manifold = true;     ///< the triangles around it are one cycle
  /// Edges to zero nodes in the node's own directions with more than two boundary triangles,
  /// and how many pairs beyond the first they have.
  int non_manifold_edges = 0, extra_pairs = 0;
};

SurfaceAtNode surface_at(const NodeLink& link) noexcept;

/// Signs around the node of `kind` at a halo index; `plus` and `zero` are valid beside it.
NodeLink link_of(const std::array<HaloSet, kNodeKinds>& plus,
                 const std::array<HaloSet, kNodeKinds>& zero,
                 NodeKind kind,
                 int node) noexcept;

/// Whether the node and three zeros beside it are a tet.
bool has_tet_of_zeros(const NodeLink& link) noexcept;

/// True only where the surface is a manifold at the node, if it is there at all: quick, and
/// true for nearly every node of a resolved surface.
///
/// With the `+` neighbours connected, the `-` neighbours connected, and no tet of four zeros,
/// more than one cycle of triangles would leave two parts of one sign on the sphere of
/// neighbours, each with a node of it.
bool is_plainly_manifold(const NodeLink& link) noexcept;

namespace internal {

/// The neighbours of a node and of the one at the end of `direction` both, in cyclic order: any
/// two that follow one another are neighbours too, and close a lattice tet.
struct Ring {
  std::array<std::uint8_t, 6> direction{};
  std::size_t size = 0;
};

constexpr bool are_neighbours(int d, int e) noexcept {
  const LatticeCoord step =
      kDirection[static_cast<std::size_t>(e)] - kDirection[static_cast<std::size_t>(d)];
  for (const LatticeCoord& direction : kDirection) {
    if (step == direction) return true;
  }
  return false;
}

constexpr Ring ring_around(int direction) noexcept {
  Ring ring;
  const auto follows = [&](int next) {
    for (std::size_t i = 0; i < ring.size; ++i) {
      if (ring.direction[i] == next) return false;
    }
    return ring.size == 0 || are_neighbours(ring.direction[ring.size - 1], next);
  };
  for (bool grown = true; grown;) {
    grown = false;
    for (int d = 0; d < kDirections && !grown; ++d) {
      if (d == direction || !are_neighbours(direction, d) || !follows(d)) continue;
      ring.direction[ring.size++] = static_cast<std::uint8_t>(d);
      grown = true;
    }
  }
  return ring;
}

}  // namespace internal

inline constexpr std::array<internal::Ring, kDirections> kRing = [] {
  std::array<internal::Ring, kDirections> rings;
  for (int d = 0; d < kDirections; ++d) {
    rings[static_cast<std::size_t>(d)] = internal::ring_around(d);
  }
  return rings;
}();
static_assert(kRing[0].size == 4 && kRing[3].size == 6, "4 tets around a long edge, 6 a short");

/// The neighbours of each direction's end among the directions.
inline constexpr std::array<DirectionSet, kDirections> kLinkNeighbours = [] {
  std::array<DirectionSet, kDirections> neighbours{};
  for (std::size_t d = 0; d < kDirections; ++d) {
    for (std::size_t i = 0; i < kRing[d].size; ++i) {
      neighbours[d] = static_cast<DirectionSet>(neighbours[d] | (1U << kRing[d].direction[i]));
    }
  }
  return neighbours;
}();

}  // namespace tet
