// Four floats that are loaded, subtracted and shuffled together.
#pragma once

#include <array>
#include <cstddef>
#include <cstring>

namespace tet {

/// x, y, z and one more that nobody reads.
using FloatRow [[gnu::vector_size(16)]] = float;

/// Eight rows (x, y, z, unused) become columns: `x[0 .. 8)`, `y[0 .. 8)` and `z[0 .. 8)`.
[[gnu::always_inline]] inline void store_transposed(const std::array<FloatRow, 8>& row,
                                                    float* x,
                                                    float* y,
                                                    float* z) noexcept {
  // Rows 0 to 3 fill the lower halves of vectors and rows 4 to 7 the upper ones.
  using Pair [[gnu::vector_size(32)]] = float;
  const auto pair = [&](std::size_t i, Pair & both) __attribute__((always_inline)) {
    both = __builtin_shufflevector(row[i], row[i + 4], 0, 1, 2, 3, 4, 5, 6, 7);
  };
  Pair a, b, c, d;
  pair(0, a);
  pair(1, b);
  pair(2, c);
  pair(3, d);
  const Pair xy01 = __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13);
  const Pair xy23 = __builtin_shufflevector(c, d, 0, 8, 1, 9, 4, 12, 5, 13);
  const Pair z01 = __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15);
  const Pair z23 = __builtin_shufflevector(c, d, 2, 10, 3, 11, 6, 14, 7, 15);
  const Pair xs = __builtin_shufflevector(xy01, xy23, 0, 1, 8, 9, 4, 5, 12, 13);
  const Pair ys = __builtin_shufflevector(xy01, xy23, 2, 3, 10, 11, 6, 7, 14, 15);
  const Pair zs = __builtin_shufflevector(z01, z23, 0, 1, 8, 9, 4, 5, 12, 13);
  std::memcpy(x, &xs, sizeof(xs));
  std::memcpy(y, &ys, sizeof(ys));
  std::memcpy(z, &zs, sizeof(zs));
}

}  // namespace tet
