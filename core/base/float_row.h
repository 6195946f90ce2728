// Four floats that are loaded, subtracted and shuffled together.
#pragma once

#include <array>
#include <cstring>

namespace tet {

/// x, y, z and one more that nobody reads.
using FloatRow [[gnu::vector_size(16)]] = float;

/// Rows (x, y, z, unused) become columns: `x[0 .. 4)`, `y[0 .. 4)` and `z[0 .. 4)`.
inline void store_transposed(const std::array<FloatRow, 4>& row,
                             float* x,
                             float* y,
                             float* z) noexcept {
  const FloatRow xy01 = __builtin_shufflevector(row[0], row[1], 0, 4, 1, 5);
  const FloatRow xy23 = __builtin_shufflevector(row[2], row[3], 0, 4, 1, 5);
  const FloatRow z01 = __builtin_shufflevector(row[0], row[1], 2, 6, 3, 7);
  const FloatRow z23 = __builtin_shufflevector(row[2], row[3], 2, 6, 3, 7);
  const auto store = [](const FloatRow& column, float* out) {
    std::memcpy(out, &column, sizeof(column));
  };
  store(__builtin_shufflevector(xy01, xy23, 0, 1, 4, 5), x);
  store(__builtin_shufflevector(xy01, xy23, 2, 3, 6, 7), y);
  store(__builtin_shufflevector(z01, z23, 0, 1, 4, 5), z);
}

}  // namespace tet
