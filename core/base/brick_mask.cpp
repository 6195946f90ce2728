#include "core/base/brick_mask.h"

#include <algorithm>
#include <emmintrin.h>

namespace tet {
namespace {

constexpr int kHaloMin = -2, kHaloMax = 13;

}  // namespace

BrickMask brick_part(const HaloSet& set) noexcept { return brick_part(set, 0, 0, 0); }

BrickMask brick_part(const HaloSet& set, int dx, int dy, int dz) noexcept {
  // Eight rows of 16 bits lie one after another: the middle byte of each is a row of cells.
  const auto* const rows = reinterpret_cast<const char*>(set.word.data());
  const __m128i byte = _mm_set1_epi16(0xff);
  BrickMask mask;
  for (int x = 0; x < 8; ++x) {
    const int row = halo_index(x + dx, dy, -2) / 16;
    const __m128i bits = _mm_loadu_si128(reinterpret_cast<const __m128i*>(rows + 2 * row));
    const __m128i cells = _mm_and_si128(_mm_srli_epi16(bits, 2 + dz), byte);
    mask.slice[static_cast<std::size_t>(x)] =
        static_cast<std::uint64_t>(_mm_cvtsi128_si64(_mm_packus_epi16(cells, cells)));
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
