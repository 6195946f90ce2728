#include "core/base/brick_neighbours.h"

#include <algorithm>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace tet {
namespace {

TEST(BrickNeighbours, AreThoseThatAnIndexFinds) {
  std::mt19937 random(7);
  std::vector<BrickCoord> bricks;
  for (int i = 0; i < 2000; ++i) {
    const auto coord = [&] { return static_cast<std::int32_t>(random() % 14) - 7; };
    bricks.push_back({coord(), coord(), coord()});
  }
  std::sort(bricks.begin(), bricks.end());
  bricks.erase(std::unique(bricks.begin(), bricks.end()), bricks.end());
  const BrickIndex index(bricks);
  for (const std::int32_t first :
       {-9, 0}) {  // from before the first brick, and from the middle
    BrickNeighbours neighbours(bricks);
    for (std::int32_t x = first; x < 9; x += 2) {
      for (std::int32_t y = -9; y < 9; ++y) {
        for (std::int32_t z = -9; z < 9; z += 3) {
          const PlacesAround& around = neighbours.around({x, y, z});
          for (int o = 0; o < 27; ++o) {
            EXPECT_EQ(around[static_cast<std::size_t>(o)],
                      index.find({x + o / 9 - 1, y + o / 3 % 3 - 1, z + o % 3 - 1}));
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace tet
