#include "core/base/brick_mask.h"

#include <algorithm>

namespace tet {
namespace {

constexpr int kHaloMin = -2, kHaloMax = 13;

}  // namespace

BrickMask brick_part(const HaloSet& set) noexcept {
  BrickMask mask;
  for (int x = 0; x < 8; ++x) {
    std::uint64_t slice = 0;
    for (int y = 0; y < 8; ++y) {
      const int row = halo_index(x, y, 0);
      const std::uint64_t bits = set.word[static_cast<std::size_t>(row >> 6)] >> (row & 63);
      slice |= (bits & 0xff) << (y * 8);
    }
    mask.slice[static_cast<std::size_t>(x)] = slice;
  }
  return mask;
}

void add_brick(HaloSet& set, const BrickMask& mask, int bx, int by, int bz) noexcept {
  // A row of 8 cells is a byte; shifted by 8*bz it lies in the row's 16 bits or falls off them.
  const int shift = 8 * bz + 2;
  for (int x = std::max(0, kHaloMin - 8 * bx); x < std::min(8, kHaloMax + 1 - 8 * bx); ++x) {
    const std::uint64_t slice = mask.slice[static_cast<std::size_t>(x)];
    if (slice == 0) continue;
    for (int y = std::max(0, kHaloMin - 8 * by); y < std::min(8, kHaloMax + 1 - 8 * by); ++y) {
      const std::uint64_t cells = slice >> (y * 8) & 0xff;
      const std::uint64_t row_bits = (shift >= 0 ? cells << shift : cells >> -shift) & 0xffff;
      const int row = halo_index(x + 8 * bx, y + 8 * by, -2);
      set.word[static_cast<std::size_t>(row >> 6)] |= row_bits << (row & 63);
    }
  }
}

}  // namespace tet
