#include "core/base/brick_mask.h"

#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace tet {
namespace {

BrickMask random_mask(std::uint32_t seed) {
  std::mt19937_64 random(seed);
  BrickMask mask;
  for (std::uint64_t& slice : mask.slice) slice = random();
  return mask;
}

TEST(BrickMask, VisitsItsBitsInTheOrderOfCoordinates) {
  const BrickMask mask = random_mask(1);
  int last = -1;
  std::uint32_t visited = 0;
  for_each_bit(mask, [&](int x, int y, int z) {
    EXPECT_TRUE(mask.test(x, y, z));
    const int place = (x * 8 + y) * 8 + z;
    EXPECT_GT(place, last);
    last = place;
    ++visited;
  });
  EXPECT_EQ(visited, mask.count());
}

TEST(HaloSet, GivesBackTheBrickThatWasPutIn) {
  const BrickMask mask = random_mask(2);
  HaloSet set;
  add_brick(set, mask, 0, 0, 0);
  EXPECT_EQ(brick_part(set), mask);
  EXPECT_EQ(set.count(), mask.count());
}

TEST(HaloSet, SeesNeighboursWhereTheyLie) {
  const BrickMask mask = random_mask(3);
  for (int bx = -1; bx <= 1; ++bx) {
    for (int by = -1; by <= 1; ++by) {
      for (int bz = -1; bz <= 1; ++bz) {
        HaloSet set;
        add_brick(set, mask, bx, by, bz);
        for (int x = -2; x < 14; ++x) {
          for (int y = -2; y < 14; ++y) {
            for (int z = -2; z < 14; ++z) {
              const int mx = x - 8 * bx, my = y - 8 * by, mz = z - 8 * bz;
              const bool within = ((mx | my | mz) & ~7) == 0;
              ASSERT_EQ(set.test(halo_index(x, y, z)), within && mask.test(mx, my, mz));
            }
          }
        }
      }
    }
  }
}

TEST(HaloSet, ShiftsByAnyOffset) {
  HaloSet set;
  add_brick(set, random_mask(4), 0, 0, 0);
  for (const int offset : {0, 1, -1, 16, -16, 64, 256, -256, 273, -273, 255}) {
    const HaloSet seen = seen_from(set, offset);
    for (int i = 0; i < kHaloNodes; ++i) {
      const int from = i + offset;
      const bool expected = from >= 0 && from < kHaloNodes && set.test(from);
      ASSERT_EQ(seen.test(i), expected) << "index " << i << " offset " << offset;
    }
  }
}

}  // namespace
}  // namespace tet
