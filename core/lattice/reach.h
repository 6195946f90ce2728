// What a brick's tets reach of the bricks beyond its upper faces: nodes [0, 8]^3 and the edges
// between them.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

#include "core/base/brick_mask.h"

namespace tet {

/// Bits of a neighbour's slice within reach.
constexpr std::uint64_t reachable_bits(int by, int bz) noexcept {
  constexpr std::uint64_t kRowZero = 0xff, kFirstOfRows = 0x0101010101010101;
  return (by == 1 ? kRowZero : ~std::uint64_t{0}) &
         (bz == 1 ? kFirstOfRows : ~std::uint64_t{0});
}

/// Where the brick 4*x + 2*y + z of the eight lies, each coordinate 0 or 1.
struct UpperOffset {
  int x, y, z;
  constexpr explicit UpperOffset(std::size_t o) noexcept
      : x(static_cast<int>(o >> 2)),
        y(static_cast<int>(o >> 1 & 1)),
        z(static_cast<int>(o & 1)) {}
};

/// Calls `visit(x, y, z, rank)` for each bit within reach in a mask of brick `o` of the eight:
/// its place as the first brick sees it, and how many bits of the mask come before it. Returns
/// the number of bits. Inlined, so that what `visit` holds stays in registers.
template <class Visit>
[[gnu::always_inline]] inline std::uint32_t for_each_in_reach(const BrickMask& mask,
                                                              std::size_t o,
                                                              const Visit& visit) noexcept {
  const auto [bx, by, bz] = UpperOffset(o);
  const std::uint64_t reachable = reachable_bits(by, bz);
  const std::size_t slices = bx == 1 ? 1 : 8;
  std::uint64_t any = 0;
  for (std::size_t x = 0; x < slices; ++x) any |= mask.slice[x];
  if ((any & reachable) == 0) return mask.count();  // as of most bricks beyond an edge
  std::uint32_t before = 0;
  for (std::size_t x = 0; x < slices; ++x) {
    const std::uint64_t slice = mask.slice[x];
    for (std::uint64_t bits = slice & reachable; bits != 0; bits &= bits - 1) {
      const int bit = std::countr_zero(bits);
      const std::uint64_t lower = slice & ((bits & -bits) - 1);
      visit(static_cast<int>(x) + 8 * bx, (bit >> 3) + 8 * by, (bit & 7) + 8 * bz,
            before + static_cast<std::uint32_t>(std::popcount(lower)));
    }
    before += static_cast<std::uint32_t>(std::popcount(slice));
  }
  return bx == 1 ? mask.count() : before;
}

}  // namespace tet
