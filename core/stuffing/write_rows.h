// Writing the tets of one shape row by row: eight cells in a row have nodes in a row.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "core/base/brick_mask.h"
#include "core/base/sse.h"
#include "core/lattice/background.h"
#include "core/stuffing/local_vertices.h"

namespace tet {
namespace internal {

/// Four tets from the ids of their first corners, their second ones, and so on.
inline void write_transposed(const std::uint32_t* a,
                             const std::uint32_t* b,
                             const std::uint32_t* c,
                             const std::uint32_t* d,
                             std::uint32_t* out) noexcept {
  const auto load = [](const std::uint32_t* from) {
    return _mm_loadu_si128(reinterpret_cast<const __m128i*>(from));
  };
  const auto store = [&](std::size_t tet, __m128i ids) {
    _mm_storeu_si128(reinterpret_cast<__m128i*>(out + 4 * tet), ids);
  };
  const __m128i ab_low = _mm_unpacklo_epi32(load(a), load(b));
  const __m128i ab_high = _mm_unpackhi_epi32(load(a), load(b));
  const __m128i cd_low = _mm_unpacklo_epi32(load(c), load(d));
  const __m128i cd_high = _mm_unpackhi_epi32(load(c), load(d));
  store(0, _mm_unpacklo_epi64(ab_low, cd_low));
  store(1, _mm_unpackhi_epi64(ab_low, cd_low));
  store(2, _mm_unpacklo_epi64(ab_high, cd_high));
  store(3, _mm_unpackhi_epi64(ab_high, cd_high));
}

inline void write_transposed(const std::uint64_t* a,
                             const std::uint64_t* b,
                             const std::uint64_t* c,
                             const std::uint64_t* d,
                             std::uint64_t* out) noexcept {
  for (int i = 0; i < 4; ++i) out = write_tet(out, a[i], b[i], c[i], d[i]);
}

}  // namespace internal

/// Fewer than this many of a slice's 64 cells are written one by one, as their rows are short.
inline constexpr int kFewCells = 48;

/// Writes the tets of `cells` and returns their end: `corner` are the slots of the tet in the
/// first cell, and `ids` the ids by slot. Four tets are written at a time, so a few places
/// behind the end may be overwritten, but none from `limit` on.
template <class Index>
[[gnu::always_inline]] inline Index* write_rows(const BrickMask& cells,
                                                const LocalTet& corner,
                                                const Index* ids,
                                                Index* out,
                                                const Index* limit) noexcept {
  const Index *const a = ids + corner[0], *const b = ids + corner[1],
                     *const c = ids + corner[2], *const d = ids + corner[3];
  for (int x = 0; x < 8; ++x) {
    std::uint64_t slice = cells.slice[static_cast<std::size_t>(x)];
    if (std::popcount(slice) < kFewCells) {
      for (; slice != 0; slice &= slice - 1) {
        const int i = cell_slot(x, std::countr_zero(slice));
        out = write_tet(out, a[i], b[i], c[i], d[i]);
      }
      continue;
    }
    for (int y = 0; slice != 0; ++y, slice >>= 8) {
      // Most rows are one run of cells.
      for (std::uint64_t row = slice & 0xff; row != 0; row &= row + (row & -row)) {
        const int z = std::countr_zero(row), count = std::countr_one(row >> z);
        const int i = node_slot(x, y, z);
        if (limit - out < 4 * kBrickEdge) {
          for (int k = i; k < i + count; ++k) out = write_tet(out, a[k], b[k], c[k], d[k]);
          continue;
        }
        internal::write_transposed(a + i, b + i, c + i, d + i, out);
        if (count > 4)
          internal::write_transposed(a + i + 4, b + i + 4, c + i + 4, d + i + 4, out + 16);
        out += 4 * count;
      }
    }
  }
  return out;
}

}  // namespace tet
