// Dihedral angles of several tets at once, in loops that compilers turn into vector
// instructions.
#pragma once

#include <array>
#include <cstddef>

#include "core/base/dihedral.h"
#include "core/base/types.h"

namespace tet {

/// Corners of a few tets, as columns.
struct TetBatch {
  static constexpr std::size_t kSize = 16;
  template <class Number>
  using Column = std::array<Number, kSize>;

  struct Corner {
    Column<double> x, y, z;
  };
  alignas(64) std::array<Corner, 4> corner;

  void set(std::size_t lane, std::size_t k, const WorldPoint& p) noexcept {
    corner[k].x[lane] = p.x;
    corner[k].y[lane] = p.y;
    corner[k].z[lane] = p.z;
  }
};

/// What is known of each tet of a batch.
struct BatchAngles {
  /// Signed squares of the cosines of the six dihedral angles, -1 to 1; -1 at a face without
  /// area.
  alignas(64) std::array<TetBatch::Column<double>, 6> cosine;
  TetBatch::Column<double> largest_cosine, smallest_cosine;
  TetBatch::Column<double> six_volumes;
};

void measure_batch(const TetBatch& batch, BatchAngles& angles) noexcept;

}  // namespace tet
