#include "core/base/brick_neighbours.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
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
    std::mt19937 steps(8);
    BrickNeighbours neighbours(bricks), below(bricks, RowsAround::kLower),
        above(bricks, RowsAround::kUpper), later(bricks, RowsAround::kLater);
    for (std::int32_t x = first; x < 9; x += 2) {
      for (std::int32_t y = -9; y < 9; ++y) {
        // Now and then the next one along z, now and then another, or the same again.
        for (std::int32_t z = -9; z < 9; z += static_cast<std::int32_t>(steps() % 4)) {
          const PlacesAround& around = neighbours.around({x, y, z});
          const PlacesAround& lower = below.around({x, y, z});
          const PlacesAround& upper = above.around({x, y, z});
          const PlacesAround& after = later.around({x, y, z});
          for (int o = 0; o < 27; ++o) {
            const int dx = o / 9 - 1, dy = o / 3 % 3 - 1, dz = o % 3 - 1;
            const std::uint32_t at = index.find({x + dx, y + dy, z + dz});
            const auto place = static_cast<std::size_t>(o);
            EXPECT_EQ(around[place], at);
            EXPECT_EQ(lower[place], dx < 1 && dy < 1 ? at : kNoBrick);
            EXPECT_EQ(upper[place], dx > -1 && dy > -1 ? at : kNoBrick);
            if (place > kItself) {
              EXPECT_EQ(after[place], at);
            }
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace tet
