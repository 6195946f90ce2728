#include "core/base/tet_batch.h"

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/quality.h"

namespace tet {
namespace {

/// Tets of any shape and orientation within a brick, and among them one without volume and one
/// that is a point.
struct SomeTets {
  std::vector<LocalPoint> points;
  std::vector<LocalTet> tets;

  explicit SomeTets(std::size_t count) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> coordinate(-1, 10);
    for (std::size_t i = 0; i < 4 * count; ++i) {
      points.push_back({coordinate(random), coordinate(random), coordinate(random)});
    }
    for (std::size_t i = 0; i < 4 * count; i += 4) {
      const auto id = [&](std::size_t k) { return static_cast<std::uint16_t>(i + k); };
      tets.push_back({id(0), id(1), id(2), id(3)});
    }
    tets[3][3] = tets[3][0];
    tets[4] = {};
  }

  std::array<WorldPoint, 4> places(std::size_t tet) const {
    std::array<WorldPoint, 4> places;
    for (std::size_t k = 0; k < 4; ++k) {
      const LocalPoint& p = points[tets[tet][k]];
      places[k] = {p.x, p.y, p.z};
    }
    return places;
  }
};

QualityStats one_by_one(const SomeTets& some) {
  QualityMeter meter;
  for (std::size_t i = 0; i < some.tets.size(); ++i) {
    const auto [a, b, c, d] = some.places(i);
    meter.add_tet(a, b, c, d);
  }
  return meter.stats();
}

QualityStats together(const SomeTets& some) {
  QualityMeter meter;
  meter.add_tets(some.points.data(), some.tets);
  return meter.stats();
}

TEST(QualityMeter, MeasuresManyTetsAsItMeasuresOne) {
  for (const std::size_t count : {5, 16, 37, 5000}) {
    const SomeTets some(count);
    const QualityStats alone = one_by_one(some), stats = together(some);
    EXPECT_EQ(stats.min_dihedral_deg, alone.min_dihedral_deg);
    EXPECT_EQ(stats.max_dihedral_deg, alone.max_dihedral_deg);
    EXPECT_NEAR(stats.volume, alone.volume, 1e-6 * static_cast<double>(count));
  }
}

/// An angle within rounding of a whole degree may be counted on either side of it.
TEST(QualityMeter, CountsAnglesWithinRoundingOfADegreeOnEitherSide) {
  const SomeTets some(5000);
  const QualityStats alone = one_by_one(some), stats = together(some);
  std::uint64_t below_alone = 0, below = 0;
  for (std::size_t d = 0; d < QualityStats::kBins; ++d) {
    below_alone += alone.histogram[d];
    below += stats.histogram[d];
    EXPECT_LE(std::max(below, below_alone) - std::min(below, below_alone), 2U) << d;
  }
  EXPECT_EQ(below, 6 * some.tets.size());
}

}  // namespace
}  // namespace tet
