#include "core/base/brick_index.h"

#include <vector>

#include <gtest/gtest.h>

namespace tet {
namespace {

TEST(BrickIndex, FindsEveryBrickAndNoOther) {
  std::vector<BrickCoord> bricks;
  for (std::int32_t x = -9; x < 9; ++x) {
    for (std::int32_t y = -9; y < 9; ++y) {
      for (std::int32_t z = -9; z < 9; ++z) {
        if ((x + y + z) % 3 == 0) bricks.push_back({x * 1000003, y, z * -77});
      }
    }
  }
  const BrickIndex index(bricks);
  for (std::uint32_t i = 0; i < bricks.size(); ++i) EXPECT_EQ(index.find(bricks[i]), i);
  EXPECT_EQ(index.find({1, 1, 2}), kNoBrick);
  EXPECT_EQ(BrickIndex().find({0, 0, 0}), kNoBrick);
}

}  // namespace
}  // namespace tet
