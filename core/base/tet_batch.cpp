#include "core/base/tet_batch.h"

#include <algorithm>
#include <cmath>

#include "core/base/tet_geometry.h"
#include "core/base/vector_clones.h"

namespace tet {
namespace {

using Column = TetBatch::Column<float>;
using FloatVector = BasicVector<float>;

/// Normals of the four faces as columns, as `face_normals` has them, and 1 / |normal|^2.
struct BatchNormals {
  alignas(64) std::array<TetBatch::Edge, 4> normal;
  std::array<Column, 4> per_square;
};

/// Degrees of asin(sqrt(t)) for t in [0, 1/2]: sqrt(t) times a polynomial that is off by 1.8e-5
/// degrees at most (found by Remez exchange).
[[gnu::always_inline]] inline float degrees_of_half(float t) noexcept {
  float sum = 6.36711902F;
  sum = sum * t - 2.55130153F;
  sum = sum * t + 4.07045747F;
  sum = sum * t + 4.05109816F;
  sum = sum * t + 9.56606067F;
  sum = sum * t + 57.2954563F;
  return std::sqrt(t) * sum;
}

/// Whole degrees of an angle whose signed squared cosine this is.
[[gnu::always_inline]] inline std::int32_t whole_degrees(float cosine) noexcept {
  constexpr float kRounding = 1e-4F;
  const float square = std::abs(cosine), rest = 1 - square;
  // Of the angle and its complement the one whose sine is known better.
  const float from_axis = degrees_of_half(square < rest ? square : rest);
  const float acute = square < rest ? 90 - from_axis : from_axis;
  const float angle = (cosine < 0 ? 180 - acute : acute) + kRounding;
  return static_cast<std::int32_t>(angle < 179.5F ? angle : 179.5F);
}

[[gnu::always_inline]] inline void find_normals(const TetBatch& __restrict batch,
                                                BatchNormals& __restrict out,
                                                Column& __restrict six_volumes) noexcept {
  const auto& [ab, ac, ad] = batch.edge;
  for (std::size_t i = 0; i < TetBatch::kSize; ++i) {
    const FloatVector u{ab.x[i], ab.y[i], ab.z[i]}, v{ac.x[i], ac.y[i], ac.z[i]};
    const FloatVector w{ad.x[i], ad.y[i], ad.z[i]};
    const std::array<FloatVector, 4> normal{cross(w - u, v - u), cross(v, w), cross(w, u),
                                            cross(u, v)};
    for (std::size_t f = 0; f < 4; ++f) {
      out.normal[f].x[i] = normal[f].x;
      out.normal[f].y[i] = normal[f].y;
      out.normal[f].z[i] = normal[f].z;
      out.per_square[f][i] = 1 / dot(normal[f], normal[f]);
    }
    six_volumes[i] = dot(u, normal[1]);
  }
}

/// The angles between faces f and g.
[[gnu::always_inline]] inline void measure_edge(const BatchNormals& __restrict in,
                                                std::size_t f,
                                                std::size_t g,
                                                std::size_t edge,
                                                BatchAngles& __restrict out) noexcept {
  const auto &m = in.normal[f], &n = in.normal[g];
  for (std::size_t i = 0; i < TetBatch::kSize; ++i) {
    const float inward = -(m.x[i] * n.x[i] + m.y[i] * n.y[i] + m.z[i] * n.z[i]);
    float cosine = (inward * in.per_square[f][i]) * (std::abs(inward) * in.per_square[g][i]);
    cosine = cosine > -1 ? cosine : -1;  // not a number becomes -1
    cosine = cosine < 1 ? cosine : 1;
    const float largest = out.largest_cosine[i], smallest = out.smallest_cosine[i];
    out.largest_cosine[i] = largest > cosine ? largest : cosine;
    out.smallest_cosine[i] = smallest < cosine ? smallest : cosine;
    out.degrees[edge][i] = whole_degrees(cosine);
  }
}

}  // namespace

void TetBatch::load(const LocalPoint* points, std::span<const LocalTet> tets) noexcept {
  for (std::size_t lane = 0; lane < kSize; ++lane) {
    const LocalTet& tet = tets[std::min(lane, tets.size() - 1)];
    const LocalPoint& from = points[tet[0]];
    for (std::size_t k = 0; k < 3; ++k) {
      const LocalPoint& to = points[tet[k + 1]];
      set(lane, k, {to.x - from.x, to.y - from.y, to.z - from.z});
    }
  }
}

TET_VECTOR_CLONES
void measure_batch(const TetBatch& __restrict batch, BatchAngles& __restrict angles) noexcept {
  BatchNormals normals;
  find_normals(batch, normals, angles.six_volumes);
  angles.largest_cosine.fill(-1);
  angles.smallest_cosine.fill(1);
  std::size_t edge = 0;
  for (std::size_t f = 0; f < 3; ++f) {
    for (std::size_t g = f + 1; g < 4; ++g, ++edge) measure_edge(normals, f, g, edge, angles);
  }
}

}  // namespace tet
