#include "core/base/tet_batch.h"

#include <algorithm>
#include <cmath>

namespace tet {
namespace {

using Column = TetBatch::Column<double>;

/// Normals of the four faces as columns, as `face_normals` has them, and 1 / |normal|^2.
struct BatchNormals {
  alignas(64) std::array<TetBatch::Corner, 4> normal;
  std::array<Column, 4> per_square;
};

void find_normals(const TetBatch& batch, BatchNormals& out, Column& six_volumes) noexcept {
  const auto& [a, b, c, d] = batch.corner;
  for (std::size_t i = 0; i < TetBatch::kSize; ++i) {
    const WorldPoint pa{a.x[i], a.y[i], a.z[i]}, pb{b.x[i], b.y[i], b.z[i]};
    const WorldPoint pc{c.x[i], c.y[i], c.z[i]}, pd{d.x[i], d.y[i], d.z[i]};
    const std::array<Vector, 4> normal = face_normals(pa, pb, pc, pd);
    for (std::size_t f = 0; f < 4; ++f) {
      out.normal[f].x[i] = normal[f].x;
      out.normal[f].y[i] = normal[f].y;
      out.normal[f].z[i] = normal[f].z;
      out.per_square[f][i] = 1 / dot(normal[f], normal[f]);
    }
    six_volumes[i] = dot(from_to(pa, pb), normal[1]);
  }
}

void find_cosines(const BatchNormals& in, std::size_t f, std::size_t g, Column& out) noexcept {
  const auto &m = in.normal[f], &n = in.normal[g];
  for (std::size_t i = 0; i < TetBatch::kSize; ++i) {
    const double inward = -(m.x[i] * n.x[i] + m.y[i] * n.y[i] + m.z[i] * n.z[i]);
    const double cosine =
        (inward * in.per_square[f][i]) * (std::abs(inward) * in.per_square[g][i]);
    out[i] = cosine > -1 ? std::min(cosine, 1.0) : -1;  // not a number becomes -1
  }
}

}  // namespace

void measure_batch(const TetBatch& batch, BatchAngles& angles) noexcept {
  BatchNormals normals;
  find_normals(batch, normals, angles.six_volumes);
  angles.largest_cosine.fill(-1);
  angles.smallest_cosine.fill(1);
  std::size_t edge = 0;
  for (std::size_t f = 0; f < 3; ++f) {
    for (std::size_t g = f + 1; g < 4; ++g, ++edge) {
      Column& cosine = angles.cosine[edge];
      find_cosines(normals, f, g, cosine);
      for (std::size_t i = 0; i < TetBatch::kSize; ++i) {
        angles.largest_cosine[i] = std::max(angles.largest_cosine[i], cosine[i]);
        angles.smallest_cosine[i] = std::min(angles.smallest_cosine[i], cosine[i]);
      }
    }
  }
}

}  // namespace tet
