#include "core/remap/common_part.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "core/remap/tet_coordinates.h"

namespace tet {
namespace {

TetPlaces random_tet(std::mt19937& random) {
  std::uniform_real_distribution<double> place(0, 1);
  TetPlaces tet;
  for (WorldPoint& p : tet) p = {place(random), place(random), place(random)};
  if (six_volumes(tet) < 0) std::swap(tet[0], tet[1]);
  return tet;
}

double volume_of(std::span<const TetPlaces> pieces) {
  double volume = 0;
  for (const TetPlaces& piece : pieces) volume += six_volumes(piece) / 6;
  return volume;
}

/// The share of random points of `one` that lie in `other`, by its volume.
double sampled_volume(const TetPlaces& one, const TetPlaces& other, std::mt19937& random) {
  constexpr int kPoints = 20000;
  std::exponential_distribution<double> weight(1);
  int found = 0;
  for (int i = 0; i < kPoints; ++i) {
    CornerShares s{weight(random), weight(random), weight(random), weight(random)};
    const double sum = s[0] + s[1] + s[2] + s[3];
    WorldPoint p;
    for (std::size_t c = 0; c < 4; ++c) {
      p = {p.x + s[c] / sum * one[c].x, p.y + s[c] / sum * one[c].y,
           p.z + s[c] / sum * one[c].z};
    }
    if (least_of(shares_of(other, p)) >= 0) ++found;
  }
  return six_volumes(one) / 6 * found / kPoints;
}

TEST(CommonPart, HasTheVolumeThatSamplesSay) {
  std::mt19937 random(7);
  CommonPart common;
  for (int i = 0; i < 40; ++i) {
    const TetPlaces one = random_tet(random), other = random_tet(random);
    const double volume = volume_of(common.of(one, other));
    EXPECT_NEAR(volume, sampled_volume(one, other, random), 0.02 * six_volumes(one) / 6 + 1e-4);
    EXPECT_NEAR(volume, volume_of(common.of(other, one)), 1e-14) << "the other way round";
  }
}

TEST(CommonPart, IsMadeOfTetsThatAreTurnedAsTheFirstIs) {
  std::mt19937 random(8);
  CommonPart common;
  for (int i = 0; i < 100; ++i) {
    const TetPlaces one = random_tet(random), other = random_tet(random);
    for (const TetPlaces& piece : common.of(one, other)) EXPECT_GE(six_volumes(piece), -1e-18);
  }
}

TEST(CommonPart, OfATetWithItselfIsAllOfIt) {
  std::mt19937 random(9);
  CommonPart common;
  for (int i = 0; i < 100; ++i) {
    const TetPlaces one = random_tet(random);
    TetPlaces turned = one;
    std::swap(turned[2], turned[3]);
    EXPECT_NEAR(volume_of(common.of(one, one)), six_volumes(one) / 6, 1e-15);
    EXPECT_NEAR(volume_of(common.of(one, turned)), six_volumes(one) / 6, 1e-15);
  }
}

TEST(CommonPart, OfTetsApartOrFlatIsNothing) {
  std::mt19937 random(10);
  CommonPart common;
  const TetPlaces one = random_tet(random);
  TetPlaces far = one, flat = one;
  for (WorldPoint& p : far) p.x += 2;
  flat[3] = flat[0];
  EXPECT_EQ(volume_of(common.of(one, far)), 0);
  EXPECT_EQ(volume_of(common.of(one, flat)), 0);
}

TEST(CommonPart, OfATetThatIsFlatButForRoundingIsNothing) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> share(-1, 2);
  CommonPart common;
  for (int i = 0; i < 10000; ++i) {
    const TetPlaces one = random_tet(random);
    TetPlaces flat = random_tet(random);
    const double b = share(random), c = share(random);
    const WorldPoint &p = flat[0], &q = flat[1], &r = flat[2];
    flat[3] = {p.x + b * (q.x - p.x) + c * (r.x - p.x), p.y + b * (q.y - p.y) + c * (r.y - p.y),
               p.z + b * (q.z - p.z) + c * (r.z - p.z)};
    EXPECT_EQ(volume_of(common.of(one, flat)), 0) << "pair " << i;
  }
}

}  // namespace
}  // namespace tet
