#include "core/stuffing/topology/plain_zeros.h"

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/vector_clones.h"
#include "core/stuffing/topology/node_link.h"

namespace tet {
namespace {

/// How far a direction leads towards the upper corner.
constexpr int height(std::size_t direction) noexcept {
  const LatticeCoord& to = kDirection[direction];
  return to.x + to.y + to.z;
}

/// The directions that a direction's end climbs to along an edge between neighbours of a node.
constexpr std::array<DirectionSet, kDirections> kHigher = [] {
  std::array<DirectionSet, kDirections> higher{};
  for (std::size_t d = 0; d < kDirections; ++d) {
    for (std::size_t e = 0; e < kDirections; ++e) {
      if ((kLinkNeighbours[d] >> e & 1) == 0 || height(e) <= height(d)) continue;
      higher[d] = static_cast<DirectionSet>(higher[d] | 1U << e);
    }
  }
  return higher;
}();

constexpr std::size_t kCorners = 8;

/// The directions as they are where a corner of the box takes the place of the upper one; by
/// which of its coordinates are lower ones.
constexpr std::array<std::array<std::uint8_t, kDirections>, kCorners> kTurned = [] {
  std::array<std::array<std::uint8_t, kDirections>, kCorners> turned{};
  for (unsigned corner = 0; corner < kCorners; ++corner) {
    const auto flipped = [&](unsigned axis, std::int32_t i) {
      return (corner >> axis & 1) != 0 ? -i : i;
    };
    for (std::size_t d = 0; d < kDirections; ++d) {
      const LatticeCoord to{flipped(0, kDirection[d].x), flipped(1, kDirection[d].y),
                            flipped(2, kDirection[d].z)};
      for (std::size_t e = 0; e < kDirections; ++e) {
        if (kDirection[e] == to) turned[corner][d] = static_cast<std::uint8_t>(e);
      }
    }
  }
  return turned;
}();

/// Where the ends of a node's edges are.
constexpr std::array<std::array<NodePlace, kDirections>, kNodeKinds> kEnds = [] {
  std::array<std::array<NodePlace, kDirections>, kNodeKinds> ends{};
  for (const NodeKind kind : {kCorner, kCentre}) {
    for (int d = 0; d < kDirections; ++d) {
      ends[kind][static_cast<std::size_t>(d)] = NodePlace(end_kind(kind, d), end_step(kind, d));
    }
  }
  return ends;
}();

/// What is known of the ends of the edges of all nodes of a kind.
struct LinkBits {
  std::array<CellBits, kDirections> plus, zero;
};

[[gnu::always_inline]] inline void load_links(const NodesNear& nodes,
                                              NodeKind kind,
                                              unsigned corner,
                                              LinkBits& links) noexcept {
  for (std::size_t d = 0; d < kDirections; ++d) {
    const NodePlace& end = kEnds[kind][kTurned[corner][d]];
    load_bits(end.in(nodes.plus), links.plus[d]);
    load_bits(end.in(nodes.zero), links.zero[d]);
  }
}

/// Notes what has no neighbour higher up: the first, and more.
struct Ends {
  CellBits any{}, more{};

  [[gnu::always_inline]] void add(const CellBits& end) noexcept {
    more |= any & end;
    any |= end;
  }
};

/// Finds the nodes whose directions of a set, which may be seen the other way round, climb to
/// one.
template <class OfDirection>
[[gnu::always_inline]] inline void find_climbing(const OfDirection& of,
                                                 CellBits& climbing) noexcept {
  Ends ends;
#pragma GCC unroll 14
  for (std::size_t d = 0; d < kDirections; ++d) {
    CellBits higher{};
#pragma GCC unroll 14
    for (std::size_t e = 0; e < kDirections; ++e) {
      if ((kHigher[d] >> e & 1) != 0) higher |= of(e);
    }
    ends.add(of(d) & ~higher);
  }
  climbing = ends.any & ~ends.more;
}

/// Finds the nodes that are in a tet of zeros, where they are zero: a long direction and two
/// that follow one another around it.
[[gnu::always_inline]] inline void find_zero_tets(const std::array<CellBits, kDirections>& zero,
                                                  CellBits& found) noexcept {
  found = CellBits{};
#pragma GCC unroll 14
  for (std::size_t d = 0; d < kDirections; ++d) {
    if (!is_long(static_cast<int>(d))) continue;
    const auto& ring = kRing[d].direction;
    found |= zero[d] & (zero[ring[0]] | zero[ring[2]]) & (zero[ring[1]] | zero[ring[3]]);
  }
}

TET_VECTOR_CLONES
void find_plain(const NodesNear& nodes,
                NodeKind kind,
                unsigned corner,
                BrickMask& plain) noexcept {
  LinkBits links;
  load_links(nodes, kind, corner, links);
  CellBits own, tets, inside, outside;
  load_bits(NodePlace(kind, {}).in(nodes.zero), own);
  find_zero_tets(links.zero, tets);
  find_climbing(
      [&](std::size_t d) __attribute__((always_inline))->const CellBits& {
        return links.plus[d];
      },
      inside);
  for (std::size_t d = 0; d < kDirections; ++d)
    links.zero[d] = ~(links.plus[d] | links.zero[d]);
  find_climbing(
      [&](std::size_t d) __attribute__((always_inline))->const CellBits& {
        return links.zero[static_cast<std::size_t>(opposite(static_cast<int>(d)))];
      },
      outside);
  store_bits(own & inside & outside & ~tets, plain);
}

}  // namespace

NodeMasks plain_zeros(const NodesNear& nodes, const BoxCorner& corner) noexcept {
  const unsigned number =
      (corner.x < 0 ? 1U : 0U) | (corner.y < 0 ? 2U : 0U) | (corner.z < 0 ? 4U : 0U);
  NodeMasks plain;
  for (const NodeKind kind : {kCorner, kCentre}) find_plain(nodes, kind, number, plain[kind]);
  return plain;
}

}  // namespace tet
