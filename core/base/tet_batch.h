// Dihedral angles of several tets at once, in loops that compilers turn into vector
// instructions.
#pragma once

#include <array>
#include <cstddef>

#include "core/base/float_row.h"

namespace tet {

/// The edges of a few tets from their first corner to each of the others, as columns.
struct TetBatch {
  static constexpr std::size_t kSize = 32;
  template <class Number>
  using Column = std::array<Number, kSize>;

  struct Edge {
    Column<float> x, y, z;
  };
  alignas(64) std::array<Edge, 3> edge;

  /// Fills all lanes; `edges_of(lane)` is the tet's three edges as an array of FloatRow.
  template <class EdgesOf>
  [[gnu::always_inline]] void load(EdgesOf edges_of) noexcept {
    constexpr std::size_t kAtOnce = 8;
    for (std::size_t lane = 0; lane < kSize; lane += kAtOnce) {
      std::array<std::array<FloatRow, kAtOnce>, 3> rows;
#pragma GCC unroll 8
      for (std::size_t i = 0; i < kAtOnce; ++i) {
        const auto edges = edges_of(lane + i);
        for (std::size_t k = 0; k < 3; ++k) rows[k][i] = edges[k];
      }
      for (std::size_t k = 0; k < 3; ++k) {
        auto& [x, y, z] = edge[k];
        store_transposed(rows[k], &x[lane], &y[lane], &z[lane]);
      }
    }
  }
};

/// What is known of each tet of a batch, by float arithmetic. Cosines are sign(cos) * cos^2,
/// and -1 at a face without area; rounding may put them beyond 1.
struct BatchAngles {
  alignas(64) std::array<TetBatch::Column<float>, 6> cosine;
  TetBatch::Column<float> largest_cosine, smallest_cosine;
  TetBatch::Column<float> six_volumes;
};

void measure_batch(const TetBatch& batch, BatchAngles& angles) noexcept;

}  // namespace tet
