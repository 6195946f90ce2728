// Background tets have the same statistics whether they are counted together or brick by brick.
#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "core/plan/brick/background_quality.h"

namespace tet {
namespace {

/// The tets of some leaves of one level.
struct SomeTets {
  BackgroundCounts counts;
  int level = 0;
};

const std::vector<SomeTets>& some_tets() {
  static const std::vector<SomeTets> tets{{{.bcc = 7, .half_pyramid = 2}, 0},
                                          {{.bcc = 100, .bisected = 12, .quadrisected = 8}, 1},
                                          {{.halved = 3, .in_three = 5}, 3},
                                          {{}, 2}};
  return tets;
}

QualityStats measured_one_by_one() {
  QualityStats sum;
  for (const SomeTets& tets : some_tets()) {
    BackgroundMeter meter;
    meter.add(tets.counts, tets.level);
    sum.add(meter.stats());
  }
  return sum;
}

QualityStats measured_together() {
  BackgroundMeter meter;
  for (const SomeTets& tets : some_tets()) meter.add(tets.counts, tets.level);
  return meter.stats();
}

TEST(BackgroundMeter, SaysTheSameOfTetsTogetherAsOneByOne) {
  const QualityStats apart = measured_one_by_one(), together = measured_together();
  EXPECT_EQ(together.histogram, apart.histogram);
  EXPECT_EQ(together.min_dihedral_deg, apart.min_dihedral_deg);
  EXPECT_EQ(together.max_dihedral_deg, apart.max_dihedral_deg);
  EXPECT_DOUBLE_EQ(together.volume, apart.volume);
}

TEST(BackgroundMeter, CountsSixAnglesATet) {
  const auto& angles = measured_together().histogram;
  std::uint64_t tets = 0;
  for (const SomeTets& some : some_tets()) tets += some.counts.total();
  EXPECT_EQ(std::accumulate(angles.begin(), angles.end(), std::uint64_t{0}), 6 * tets);
}

TEST(BackgroundMeter, HasNoAnglesOfShapesThatThereAreNot) {
  BackgroundMeter meter;
  meter.add({.bcc = 5}, 0);
  EXPECT_NEAR(meter.stats().min_dihedral_deg, 60, 1e-4);
  EXPECT_NEAR(meter.stats().max_dihedral_deg, 90, 1e-4);
  EXPECT_TRUE(BackgroundMeter().stats().empty());
}

}  // namespace
}  // namespace tet
