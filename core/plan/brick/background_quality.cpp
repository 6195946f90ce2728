#include "core/plan/brick/background_quality.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <initializer_list>

#include "core/base/quality.h"

namespace tet {
namespace {

/// Statistics of one tet of each background shape on a lattice of spacing 1.
struct BackgroundShapes {
  QualityStats bcc, bisected, quadrisected, half_pyramid;
  QualityStats halved, in_three;  ///< the two, and the three, tets of a half pyramid
};

/// What is known of a shape, and how many tets, or halves of pyramids, have it.
struct CountedShape {
  QualityStats BackgroundShapes::*shape;
  std::uint64_t BackgroundCounts::*count;
};
constexpr std::array<CountedShape, 6> kCountedShapes{
    {{&BackgroundShapes::bcc, &BackgroundCounts::bcc},
     {&BackgroundShapes::bisected, &BackgroundCounts::bisected},
     {&BackgroundShapes::quadrisected, &BackgroundCounts::quadrisected},
     {&BackgroundShapes::half_pyramid, &BackgroundCounts::half_pyramid},
     {&BackgroundShapes::halved, &BackgroundCounts::halved},
     {&BackgroundShapes::in_three, &BackgroundCounts::in_three}}};

using TetPoints = std::array<LocalPoint, 4>;

QualityStats stats_of(std::initializer_list<TetPoints> tets) {
  constexpr LocalTet kInOrder{0, 1, 2, 3};
  QualityMeter meter;
  for (const TetPoints& points : tets) meter.add_tets(points.data(), {&kInOrder, 1});
  return meter.stats();
}

const BackgroundShapes& background_shapes() {
  // Cell [0, 1]^3 with its upper face across x, seen from the centre.
  constexpr LocalPoint kLow{0.5F, 0.5F, 0.5F}, kHigh{1.5F, 0.5F, 0.5F};
  constexpr LocalPoint kFace{1, 0.5F, 0.5F}, kMiddle{1, 0.5F, 0};
  constexpr LocalPoint kCorner0{1, 0, 0}, kCorner1{1, 1, 0}, kCorner2{1, 1, 1};
  constexpr LocalPoint kNext{1, 1, 0.5F};  // between corners 1 and 2
  const auto tet = [&](LocalPoint a, LocalPoint b, LocalPoint c) {
    return TetPoints{kLow, a, b, c};
  };
  static const BackgroundShapes shapes{
      .bcc = stats_of({tet(kHigh, kCorner0, kCorner1)}),
      .bisected = stats_of({tet(kHigh, kCorner0, kMiddle)}),
      .quadrisected = stats_of({tet(kFace, kCorner0, kMiddle)}),
      .half_pyramid = stats_of({tet(kCorner0, kCorner1, kCorner2)}),
      .halved = stats_of({tet(kCorner0, kMiddle, kCorner2), tet(kMiddle, kCorner1, kCorner2)}),
      .in_three = stats_of({tet(kMiddle, kCorner1, kNext), tet(kCorner0, kMiddle, kNext),
                            tet(kCorner0, kNext, kCorner2)})};
  return shapes;
}

double determinant(const std::array<std::array<double, 3>, 3>& m) noexcept {
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
         m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

}  // namespace

void BackgroundMeter::add(const BackgroundCounts& counts, int level) noexcept {
  const double scale = std::ldexp(1.0, 3 * level);
  for (const auto& [shape, of_shape] : kCountedShapes) {
    const std::uint64_t count = counts.*of_shape;
    if (count == 0) continue;
    counts_.*of_shape += count;
    volume_ += static_cast<double>(count) * scale * (background_shapes().*shape).volume;
  }
}

QualityStats BackgroundMeter::stats() const noexcept {
  QualityStats stats;
  for (const auto& [shape, of_shape] : kCountedShapes) {
    stats.add_copies(background_shapes().*shape, counts_.*of_shape, 0);
  }
  stats.volume = volume_;
  return stats;
}

double volume_scale(const LatticeToWorld& to_world) noexcept {
  return std::abs(determinant(to_world.linear));
}

}  // namespace tet
