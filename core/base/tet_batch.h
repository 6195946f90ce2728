// Dihedral angles of several tets at once, in loops that compilers turn into vector
// instructions.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/local_point.h"
#include "core/base/tet_geometry.h"

namespace tet {

/// The edges of a few tets from their first corner to each of the others, as columns.
struct TetBatch {
  static constexpr std::size_t kSize = 16;
  template <class Number>
  using Column = std::array<Number, kSize>;

  struct Edge {
    Column<float> x, y, z;
  };
  alignas(64) std::array<Edge, 3> edge;

  /// The tet of one lane, relative to its first corner.
  void set(std::size_t lane, std::size_t k, const BasicVector<float>& e) noexcept {
    edge[k].x[lane] = e.x;
    edge[k].y[lane] = e.y;
    edge[k].z[lane] = e.z;
  }

  /// One to `kSize` tets; lanes beyond repeat the last one.
  void load(const LocalPoint* points, std::span<const LocalTet> tets) noexcept;
};

/// What is known of each tet of a batch.
struct BatchAngles {
  /// The six dihedral angles in whole degrees, 0 to 179. An angle less than 1e-4 below a whole
  /// degree may count as that degree, so that rounding does not tear 60, 90 or 120 in two.
  alignas(64) std::array<TetBatch::Column<std::int32_t>, 6> degrees;
  /// Of the smallest and the largest angle: sign(cos) * cos^2; -1 at a face without area.
  TetBatch::Column<float> largest_cosine, smallest_cosine;
  TetBatch::Column<float> six_volumes;
};

void measure_batch(const TetBatch& batch, BatchAngles& angles) noexcept;

}  // namespace tet
