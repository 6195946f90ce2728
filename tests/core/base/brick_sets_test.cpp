#include "core/base/brick_sets.h"

#include <algorithm>
#include <random>
#include <set>

#include <gtest/gtest.h>

namespace tet {
namespace {

/// Bricks within `half_edge` of the origin, some more than once.
std::vector<BrickCoord> random_bricks(std::size_t count, std::int32_t half_edge) {
  std::mt19937 random(static_cast<unsigned>(count));
  std::uniform_int_distribution<std::int32_t> at(-half_edge, half_edge);
  std::vector<BrickCoord> bricks(count);
  for (BrickCoord& b : bricks) b = {at(random), at(random), at(random)};
  bricks.insert(bricks.end(), bricks.begin(), bricks.begin() + static_cast<long>(count / 3));
  return bricks;
}

void expect_sorted_as_a_set(std::vector<BrickCoord> bricks) {
  const std::set<BrickCoord> set(bricks.begin(), bricks.end());
  sort_unique(bricks);
  EXPECT_TRUE(std::ranges::equal(bricks, set));
}

TEST(BrickSets, SortFewAndManyNearAndFarApart) {
  for (const std::size_t count : {0U, 1U, 100U, 3000U}) {
    for (const std::int32_t half_edge : {0, 5, 3000, 1 << 20, 1 << 30}) {
      expect_sorted_as_a_set(random_bricks(count, half_edge));
    }
  }
}

TEST(BrickSets, SortWhatLiesAlongALine) {
  std::vector<BrickCoord> line = random_bricks(2000, 1 << 30);
  for (BrickCoord& b : line) b.x = b.z = -7;
  expect_sorted_as_a_set(line);
}

TEST(BrickSets, TakeInAllNeighbours) {
  std::vector<BrickCoord> bricks = random_bricks(300, 16);
  for (BrickCoord& b : bricks) b = {16 * b.x, 16 * b.y, 16 * b.z};
  std::set<BrickCoord> expected;
  for (const BrickCoord b : bricks) {
    for (int o = 0; o < 27; ++o) {
      expected.insert(
          {b.x + 16 * (o / 9 - 1), b.y + 16 * (o / 3 % 3 - 1), b.z + 16 * (o % 3 - 1)});
    }
  }
  sort_unique(bricks);
  EXPECT_TRUE(std::ranges::equal(with_neighbours(bricks, 16), expected));
}

}  // namespace
}  // namespace tet
