#include "core/base/brick_sets.h"

#include <algorithm>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "tests/support/counted_looks.h"
#include "tests/support/sanitized.h"

namespace tet {
namespace {

using test::CountedLooks;

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

TEST(BrickSets, TakeInNoMoreNeighboursThanAreOfUse) {
  std::vector<BrickCoord> apart;
  for (std::int32_t i = 0; i < 1000; ++i) apart.push_back({9 * i, 0, 0});
  EXPECT_EQ(with_neighbours(apart, 1, 27'000).size(), 27'000U);
  const std::size_t some = with_neighbours(apart, 1, 2000).size();
  EXPECT_GT(some, 2000U);
  EXPECT_LE(some, 6000U);
}

TEST(BrickSets, LookWhetherTheyAreCancelledBetweenFewBricksOfEachPass) {
  constexpr std::size_t kBricks = 6 * kBricksPerLook;
  for (const std::int32_t half_edge : {3000, 1 << 30}) {  // by numbers, and by comparing
    const std::vector<BrickCoord> unsorted = random_bricks(kBricks, half_edge);
    const std::size_t pieces = unsorted.size() / kBricksPerLook;
    std::vector<BrickCoord> bricks = unsorted;
    CountedLooks whole;
    sort_unique(bricks, whole.cancellation);
    EXPECT_GT(whole.looks, 4 * pieces) << half_edge;  // a few passes over all
    EXPECT_TRUE(std::ranges::is_sorted(bricks));
    EXPECT_LT(bricks.size(), unsorted.size());  // each is there once
    const auto step = test::sanitized_or<std::size_t>(25, 5);
    for (std::size_t most = 0; most < whole.looks; most += step) {
      bricks = unsorted;
      CountedLooks cut{most};
      sort_unique(bricks, cut.cancellation);
      EXPECT_LE(cut.looks, most + 4) << half_edge;  // it went on to nothing else
    }
  }
}

}  // namespace
}  // namespace tet
