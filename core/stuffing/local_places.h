// What numbering and placing the vertices of a brick is made of: ids along rows of nodes, and
// points on lattice edges.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "core/base/brick_mask.h"
#include "core/base/local_point.h"
#include "core/lattice/bcc.h"
#include "core/lattice/reach.h"
#include "core/stuffing/local_vertices.h"

namespace tet {

/// How many bits of a byte come before each of its bits; of a width that fills a register.
inline constexpr auto kRanks = [] {
  std::array<std::array<std::uint16_t, 8>, 256> ranks{};
  for (unsigned byte = 0; byte < 256; ++byte) {
    for (unsigned bit = 0; bit < 8; ++bit) {
      ranks[byte][bit] = static_cast<std::uint16_t>(std::popcount(byte & ((1U << bit) - 1)));
    }
  }
  return ranks;
}();

/// Gives the set bits of the neighbour at `o` ids from `next` on and enters those within reach
/// into `ids`, by node_slot; returns the next id. Whole rows are written, whatever bits they
/// have: what has no bit is no vertex.
template <class Index>
[[gnu::always_inline]] inline Index number_nodes(const BrickMask& mask,
                                                 std::size_t o,
                                                 Index next,
                                                 Index* ids) noexcept {
  const auto [bx, by, bz] = UpperOffset(o);
  const int slices = bx == 1 ? 1 : 8, rows = by == 1 ? 1 : 8;
  for (int x = 0; x < slices; ++x) {
    std::uint64_t slice = mask.slice[static_cast<std::size_t>(x)];
    for (int y = 0; y < rows; ++y, slice >>= 8) {
      const std::uint64_t row = slice & 0xff;
      Index* const out = ids + node_slot(x + 8 * bx, y + 8 * by, 8 * bz);
      if (bz == 1) {
        *out = next;
      } else {
        const std::array<std::uint16_t, 8>& ranks = kRanks[row];
        for (std::size_t z = 0; z < 8; ++z) out[z] = next + ranks[z];
      }
      next += static_cast<Index>(std::popcount(row));
    }
    if (by == 1) next += static_cast<Index>(std::popcount(slice));
  }
  for (std::size_t x = static_cast<std::size_t>(slices); x < 8; ++x) {
    next += static_cast<Index>(std::popcount(mask.slice[x]));
  }
  return next;
}

/// Lattice nodes by slot.
inline constexpr auto kLatticePoints = [] {
  std::array<LocalPoint, kFirstCutSlot> points{};
  for (int slot = 0; slot < kFirstCutSlot; ++slot) {
    const int node = slot % kSlotsOfKind;
    const float half = slot < kSlotsOfKind ? 0 : 0.5F;
    const int x = node / 81, y = node / 9 % 9, z = node % 9;
    points[static_cast<std::size_t>(slot)] = {static_cast<float>(x) + half,
                                              static_cast<float>(y) + half,
                                              static_cast<float>(z) + half};
  }
  return points;
}();

/// From a node to the point at fraction t of the edge in a direction: start + t * along. As
/// fractions run from the lower node, opposite directions start at their end.
struct Slide {
  LocalPoint start{}, along{};
};
inline constexpr auto kSlides = [] {
  std::array<Slide, kDirections> slides{};
  for (std::size_t d = 0; d < kDirections; ++d) {
    const auto half = [](int v) { return 0.5F * static_cast<float>(v); };
    const LatticeCoord to = kDirection[d];
    const LocalPoint there{half(to.x), half(to.y), half(to.z)};
    slides[d].along = there;
    if (d < kOwnedDirections) continue;
    slides[d] = {there, {-there.x, -there.y, -there.z}};
  }
  return slides;
}();

}  // namespace tet
