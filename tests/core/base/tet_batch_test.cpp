#include "core/base/tet_batch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/dihedral.h"
#include "core/base/lane_angles.h"
#include "core/base/quality.h"

namespace tet {
namespace {

struct SomeTets {
  std::vector<LocalPoint> points;
  std::vector<LocalTet> tets;

  void add(std::array<LocalPoint, 4> corners) {
    const auto first = static_cast<std::uint16_t>(points.size());
    for (const LocalPoint& corner : corners) points.push_back(corner);
    tets.push_back({first, static_cast<std::uint16_t>(first + 1),
                    static_cast<std::uint16_t>(first + 2),
                    static_cast<std::uint16_t>(first + 3)});
  }

  std::array<WorldPoint, 4> places(std::size_t tet) const {
    std::array<WorldPoint, 4> places;
    for (std::size_t k = 0; k < 4; ++k) {
      const LocalPoint& p = points[tets[tet][k]];
      places[k] = {p.x, p.y, p.z};
    }
    return places;
  }

  QualityStats measured() const {
    QualityMeter meter;
    meter.add_tets(points.data(), tets);
    return meter.stats();
  }
};

/// Tets of any shape and orientation within a brick, and among them one without volume and one
/// that is a point.
SomeTets any_tets(std::size_t count) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> coordinate(-1, 10);
  const auto any = [&] {
    return LocalPoint{coordinate(random), coordinate(random), coordinate(random)};
  };
  SomeTets some;
  for (std::size_t i = 0; i < count; ++i) some.add({any(), any(), any(), any()});
  some.tets[3][3] = some.tets[3][0];
  some.tets[4] = {};
  return some;
}

/// BCC tets all over a brick whose nodes moved by up to a quarter of a spacing.
SomeTets moved_tets(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> moved(-0.25F, 0.25F);
  std::uniform_int_distribution<int> cell(0, 7);
  SomeTets some;
  for (std::size_t i = 0; i < count; ++i) {
    const auto x = static_cast<float>(cell(random)), y = static_cast<float>(cell(random));
    const auto z = static_cast<float>(cell(random));
    const auto at = [&](float u, float v, float w) {
      return LocalPoint{x + u + moved(random), y + v + moved(random), z + w + moved(random)};
    };
    some.add({at(0.5F, 0.5F, 0.5F), at(1.5F, 0.5F, 0.5F), at(1, 0, 0), at(1, 1, 0)});
  }
  return some;
}

/// In double, and by nothing that the meter uses for many.
struct Expected {
  std::vector<double> degrees;  // ascending
  double volume = 0;

  explicit Expected(const SomeTets& some) {
    for (std::size_t i = 0; i < some.tets.size(); ++i) {
      const auto [a, b, c, d] = some.places(i);
      const std::array<Vector, 4> normal = face_normals(a, b, c, d);
      volume += dot(from_to(a, b), normal[1]) / 6;
      for (const double cosine : dihedral_cosines(normal)) {
        degrees.push_back(degrees_of(cosine));
      }
    }
    std::sort(degrees.begin(), degrees.end());
  }

  std::uint64_t below(double limit) const {
    const auto end = std::lower_bound(degrees.begin(), degrees.end(), limit);
    return static_cast<std::uint64_t>(end - degrees.begin());
  }
};

TetBatch batch_of(const SomeTets& some) {
  TetBatch batch;
  batch.load([&](std::size_t lane) {
    const auto [a, b, c, d] = some.tets[lane];
    const FloatRow from = row_of(some.points[a]);
    return std::array{row_of(some.points[b]) - from, row_of(some.points[c]) - from,
                      row_of(some.points[d]) - from};
  });
  return batch;
}

TEST(TetBatch, HasTheBitsOfOneTetAfterTheOtherOnAnyProcessor) {
  const TetBatch batch = batch_of(any_tets(TetBatch::kSize));
  BatchAngles angles;
  measure_batch(batch, angles);
  const auto& [u, v, w] = batch.edge;
  for (std::size_t i = 0; i < TetBatch::kSize; ++i) {
    const LaneAngles lane = measure_lane({u.x[i], u.y[i], u.z[i]}, {v.x[i], v.y[i], v.z[i]},
                                         {w.x[i], w.y[i], w.z[i]});
    EXPECT_EQ(angles.six_volumes[i], lane.six_volumes);
    for (std::size_t e = 0; e < 6; ++e) EXPECT_EQ(angles.cosine[e][i], lane.cosine[e]);
    EXPECT_EQ(angles.largest_cosine[i], *std::ranges::max_element(lane.cosine));
    EXPECT_EQ(angles.smallest_cosine[i], *std::ranges::min_element(lane.cosine));
  }
}

TEST(DegreeHistogram, HasTheBitsOfOneAngleAfterTheOtherOnAnyProcessor) {
  BatchAngles angles;
  measure_batch(batch_of(any_tets(TetBatch::kSize)), angles);
  DegreeHistogram histogram;
  histogram.add(angles.cosine, TetBatch::kSize);
  std::array<std::uint64_t, DegreeHistogram::kBins> expected{};
  for (const auto& column : angles.cosine) {
    for (const float cosine : column) {
      ++expected[static_cast<std::size_t>(std::min(whole_degrees(cosine), 179))];
    }
  }
  EXPECT_EQ(histogram.counts(), expected);
}

TEST(QualityMeter, FindsTheExtremesThatDoubleArithmeticFinds) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    const SomeTets some = moved_tets(500 + seed, seed);
    const Expected expected(some);
    const QualityStats stats = some.measured();
    EXPECT_EQ(stats.min_dihedral_deg, expected.degrees.front()) << seed;
    EXPECT_EQ(stats.max_dihedral_deg, expected.degrees.back()) << seed;
  }
}

TEST(QualityMeter, FindsTheVolumeToAMillionth) {
  const SomeTets some = moved_tets(5000, 1);
  const double volume = Expected(some).volume;
  EXPECT_NEAR(some.measured().volume, volume, 1e-6 * volume);
}

TEST(QualityMeter, CountsAnglesWithinRoundingOfADegreeInEitherOfTwoBins) {
  constexpr double kTooHigh = 4e-4, kTooLow = 1e-4;
  const SomeTets some = moved_tets(16000, 2);
  const Expected expected(some);
  std::uint64_t below = 0;
  const QualityStats stats = some.measured();
  for (std::size_t d = 0; d < QualityStats::kBins; ++d) {
    EXPECT_GE(below, expected.below(static_cast<double>(d) - kTooHigh)) << d;
    EXPECT_LE(below, expected.below(static_cast<double>(d) + kTooLow)) << d;
    below += stats.histogram[d];
  }
  EXPECT_EQ(below, 6 * some.tets.size());
}

/// Counts of a tet with one corner in the middle of cell [0, 1]^3.
std::array<std::uint64_t, QualityStats::kBins> around_middle(LocalPoint a,
                                                             LocalPoint b,
                                                             LocalPoint c) {
  SomeTets one;
  one.add({LocalPoint{0.5F, 0.5F, 0.5F}, a, b, c});
  return one.measured().histogram;
}

TEST(QualityMeter, CountsTheAnglesOfTheBackgroundAsWholeDegrees) {
  const auto bcc = around_middle({1.5F, 0.5F, 0.5F}, {1, 0, 0}, {1, 1, 0});
  EXPECT_EQ(bcc[60], 4U);
  EXPECT_EQ(bcc[90], 2U);
  const auto bisected = around_middle({1.5F, 0.5F, 0.5F}, {1, 0, 0}, {1, 0.5F, 0});
  EXPECT_EQ(bisected[45] + bisected[60] + bisected[90], 6U);
  const auto quadrisected = around_middle({1, 0.5F, 0.5F}, {1, 0, 0}, {1, 0.5F, 0});
  EXPECT_EQ(quadrisected[45] + quadrisected[60] + quadrisected[90], 6U);
  const auto half_pyramid = around_middle({1, 0, 0}, {1, 1, 0}, {1, 1, 1});
  EXPECT_EQ(half_pyramid[45] + half_pyramid[60] + half_pyramid[90] + half_pyramid[120], 6U);
  EXPECT_EQ(half_pyramid[120], 1U);
}

TEST(QualityMeter, CountsAnglesAtAFaceWithoutAreaAsFlat) {
  SomeTets point;
  point.add({});
  const QualityStats stats = point.measured();
  EXPECT_EQ(stats.max_dihedral_deg, 180);
  EXPECT_EQ(stats.histogram[179], 6U);
}

TEST(QualityMeter, FindsTheSameInOneCallAndInMany) {
  const SomeTets some = moved_tets(1000, 4);
  QualityMeter in_parts;
  for (std::size_t first = 0, count = 1; first < some.tets.size(); first += count++) {
    const std::span<const LocalTet> rest = std::span(some.tets).subspan(first);
    in_parts.add_tets(some.points.data(), rest.first(std::min(count, rest.size())));
  }
  const QualityStats at_once = some.measured(), parts = in_parts.stats();
  EXPECT_EQ(at_once.min_dihedral_deg, parts.min_dihedral_deg);
  EXPECT_EQ(at_once.max_dihedral_deg, parts.max_dihedral_deg);
  EXPECT_EQ(at_once.histogram, parts.histogram);
  EXPECT_NEAR(at_once.volume, parts.volume, 1e-12 * at_once.volume);
}

}  // namespace
}  // namespace tet
