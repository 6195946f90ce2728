#include "core/stuffing/node_link.h"

#include <bit>

namespace tet {
namespace {

bool has(DirectionSet set, std::size_t direction) noexcept {
  return (set >> direction & 1) != 0;
}

template <class Visit>
void for_each_direction(DirectionSet set, const Visit& visit) {
  for (unsigned bits = set; bits != 0; bits &= bits - 1) {
    visit(static_cast<std::size_t>(std::countr_zero(bits)));
  }
}

/// Boundary triangles at the edge between two zero nodes. Around it lie tets of two ring nodes
/// each: `+` and `+`, or `+` and `0`, are inside; the surface runs through `+` and `-`.
int triangles_at_edge(const NodeLink& link, std::size_t direction) noexcept {
  const auto& ring = kRing[direction];
  int triangles = 0;
  for (std::size_t i = 0; i < ring.size; ++i) {
    const std::size_t at = ring.direction[i];
    const std::size_t next = ring.direction[i + 1 == ring.size ? 0 : i + 1];
    const bool plus = has(link.plus, at), next_plus = has(link.plus, next);
    if (has(link.zero, at)) {
      const std::size_t before = ring.direction[i == 0 ? ring.size - 1 : i - 1];
      if (has(link.plus, before) != next_plus) ++triangles;
    } else if (!has(link.zero, next) && plus != next_plus) {
      ++triangles;
    }
  }
  return triangles;
}

/// Vertices - edges + triangles of the part of the link that lies between `+` nodes.
int euler_characteristic(DirectionSet plus) noexcept {
  int vertices = 0, edge_ends = 0, triangle_corners = 0;
  for_each_direction(plus, [&](std::size_t d) {
    ++vertices;
    edge_ends += std::popcount(static_cast<unsigned>(plus & kLinkNeighbours[d]));
    const auto& ring = kRing[d];
    for (std::size_t i = 0; i < ring.size; ++i) {
      const std::size_t next = ring.direction[i + 1 == ring.size ? 0 : i + 1];
      triangle_corners += has(plus, ring.direction[i]) && has(plus, next);
    }
  });
  return vertices - edge_ends / 2 + triangle_corners / 3;
}

/// Zero nodes of the link that lie within the inside, and the edges between zero nodes that do.
struct InnerZeros {
  int nodes = 0, edges = 0;
  std::array<DirectionSet, kDirections> beyond{};  ///< `+` nodes joined across such edges
};

InnerZeros inner_zeros(const NodeLink& link) noexcept {
  InnerZeros inner;
  for_each_direction(link.zero, [&](std::size_t z) {
    const bool beside_plus = (link.plus & kLinkNeighbours[z]) != 0;
    if (beside_plus && triangles_at_edge(link, z) == 0) ++inner.nodes;
    const auto& ring = kRing[z];
    for (std::size_t i = 0; i < ring.size; ++i) {
      const std::size_t other = ring.direction[i];
      if (other < z || !has(link.zero, other)) continue;
      const std::size_t a = ring.direction[i == 0 ? ring.size - 1 : i - 1];
      const std::size_t b = ring.direction[i + 1 == ring.size ? 0 : i + 1];
      if (!has(link.plus, a) || !has(link.plus, b)) continue;
      ++inner.edges;
      inner.beyond[a] = static_cast<DirectionSet>(inner.beyond[a] | (1U << b));
      inner.beyond[b] = static_cast<DirectionSet>(inner.beyond[b] | (1U << a));
    }
  });
  return inner;
}

/// Connected parts of the inside, as the link sees it.
int components(DirectionSet plus, const InnerZeros& inner) noexcept {
  int count = 0;
  while (plus != 0) {
    ++count;
    DirectionSet front = static_cast<DirectionSet>(plus & -plus);
    while (front != 0) {
      plus = static_cast<DirectionSet>(plus & ~front);
      DirectionSet next = 0;
      for_each_direction(front, [&](std::size_t d) {
        next = static_cast<DirectionSet>(next | kLinkNeighbours[d] | inner.beyond[d]);
      });
      front = static_cast<DirectionSet>(next & plus);
    }
  }
  return count;
}

}  // namespace

SurfaceAtNode surface_at(const NodeLink& link) noexcept {
  SurfaceAtNode surface;
  for_each_direction(link.zero, [&](std::size_t d) {
    const int pairs = triangles_at_edge(link, d) / 2;
    if (pairs <= 1) return;
    surface.manifold = false;
    if (d >= kOwnedDirections) return;
    ++surface.non_manifold_edges;
    surface.extra_pairs += pairs - 1;
  });
  // The inside, on the sphere, is an open surface: its parts have 2 * parts - chi ends in all,
  // and each end is a cycle of boundary triangles.
  const InnerZeros inner = inner_zeros(link);
  const int chi = euler_characteristic(link.plus) + inner.nodes - inner.edges;
  const int cycles = 2 * components(link.plus, inner) - chi;
  surface.on_surface = cycles > 0;
  if (cycles > 1) surface.manifold = false;
  return surface;
}

}  // namespace tet
