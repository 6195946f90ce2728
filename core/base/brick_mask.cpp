#include "core/base/brick_mask.h"

#include <algorithm>

#include "core/base/sse.h"

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
  // A row of 8 cells is a byte; widened to the 16 bits of the set's rows, and shifted along z
  // and y, what lies beyond the halo falls off.
  auto* const rows = reinterpret_cast<char*>(set.word.data());
  const __m128i up = _mm_cvtsi32_si128(bz < 0 ? 0 : 8 * bz + 2);
  const __m128i down = _mm_cvtsi32_si128(bz < 0 ? -8 * bz - 2 : 0);
  const int first_y = by < 0 ? kHaloMin : 8 * by - (by > 0 ? 2 : 0);
  for (int x = std::max(0, kHaloMin - 8 * bx); x < std::min(8, kHaloMax + 1 - 8 * bx); ++x) {
    const std::uint64_t slice = mask.slice[static_cast<std::size_t>(x)];
    if (slice == 0) continue;
    const __m128i bytes = _mm_cvtsi64_si128(static_cast<long long>(slice));
    __m128i cells = _mm_unpacklo_epi8(bytes, _mm_setzero_si128());
    cells = _mm_srl_epi16(_mm_sll_epi16(cells, up), down);
    if (by < 0) cells = _mm_srli_si128(cells, 12);  // rows 6 and 7 are the first two
    if (by > 0) cells = _mm_slli_si128(cells, 4);   // rows 0 to 5 are the last six
    auto* const at =
        reinterpret_cast<__m128i*>(rows + 2 * (halo_index(x + 8 * bx, first_y, kHaloMin) / 16));
    _mm_storeu_si128(at, _mm_or_si128(_mm_loadu_si128(at), cells));
  }
}

}  // namespace tet
