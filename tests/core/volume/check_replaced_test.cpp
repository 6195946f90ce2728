#include "core/volume/check_replaced.h"

#include <algorithm>
#include <cstddef>
#include <random>
#include <span>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/brick_sets.h"
#include "core/volume/replace_leaves.h"
#include "tests/support/solids.h"

namespace tet {
namespace {

using testing::HasSubstr;

std::vector<float> values_of(const Volume& volume, std::size_t leaf) {
  const auto values = std::span(volume.values).subspan(leaf * kBrickCells, kBrickCells);
  return {values.begin(), values.end()};
}

/// The volume with one leaf of other values.
Volume with_leaf(const Volume& volume, BrickCoord brick, const std::vector<float>& values) {
  return replace_leaves(volume, {{brick, values}}).value();
}

TEST(CheckReplaced, FindsNothingWhereAllThatDiffersIsNamed) {
  const Volume ball = test::ball(20);
  std::mt19937 random(3);
  for (int turn = 0; turn < 20; ++turn) {
    std::vector<BrickCoord> replaced;
    Volume changed = ball;
    for (int i = 0; i < 3; ++i) {
      const std::size_t leaf = random() % ball.bricks.size();
      std::vector<float> values = values_of(ball, leaf);
      for (float& value : values) value += 0.5F;
      if (i == 1) values = {ball.background};
      changed = with_leaf(changed, ball.bricks[leaf], values);
      replaced.push_back(ball.bricks[leaf]);
    }
    std::vector<BrickCoord> differing = replaced;
    sort_unique(differing);
    replaced.push_back({1, 1, 1});  // as it was, in most turns
    sort_unique(replaced);
    ASSERT_TRUE(alike_but_for_leaves(ball, changed));
    EXPECT_TRUE(check_replaced(ball, changed, replaced).ok());
    EXPECT_TRUE(check_replaced(changed, ball, replaced).ok());
    const std::vector<BrickCoord> everything = with_neighbours(ball.bricks);
    EXPECT_EQ(changed_among(ball, changed, everything), differing);
    EXPECT_EQ(changed_among(changed, ball, replaced), differing);
    // Each of them is missed: those further apart than a brick by their bounds.
    for (const BrickCoord brick : replaced) {
      if (brick == BrickCoord{1, 1, 1}) continue;
      std::vector<BrickCoord> rest = replaced;
      std::erase(rest, brick);
      EXPECT_FALSE(check_replaced(ball, changed, rest).ok());
    }
  }
}

TEST(CheckReplaced, FindsValuesWithinTheSameBoundsBesideWhatIsNamed) {
  const Volume ball = test::ball(20);
  const std::size_t leaf = ball.bricks.size() / 2;
  const BrickCoord at = ball.bricks[leaf];
  std::vector<float> values = values_of(ball, leaf);
  std::swap(*std::ranges::min_element(values), *std::ranges::max_element(values));
  const Volume changed = with_leaf(ball, at, values);
  EXPECT_TRUE(check_replaced(ball, changed, {at}).ok());
  for (const BrickCoord beside : with_neighbours({at})) {
    if (beside == at) continue;
    const absl::Status status = check_replaced(ball, changed, {beside});
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
    EXPECT_THAT(status.message(), HasSubstr("replaced"));
  }
  // That is the caller's word.
  EXPECT_TRUE(check_replaced(ball, changed, {{at.x + 2, at.y, at.z}}).ok());
}

TEST(CheckReplaced, FindsConstantsAndLeavesThatCameOrWent) {
  const Volume ball = test::ball(20);
  const std::vector<float> other(kBrickCells, 1.0F);
  const std::vector<float> constant{-2.5F};
  const BrickCoord inside{0, 0, 0};
  const BrickCoord stored = ball.bricks.front();
  for (const Volume& changed :
       {with_leaf(ball, inside, constant), with_leaf(ball, stored, {ball.background})}) {
    EXPECT_FALSE(check_replaced(ball, changed, {}).ok());
    EXPECT_FALSE(check_replaced(changed, ball, {}).ok());
  }
  EXPECT_TRUE(check_replaced(ball, with_leaf(ball, inside, constant), {inside}).ok());
  EXPECT_TRUE(check_replaced(ball, ball, {}).ok());
}

TEST(CheckReplaced, IsNoMatterOfVolumesThatAreLaidOutDifferently) {
  const Volume ball = test::ball(20);
  Volume other = ball;
  other.background += 1;
  EXPECT_FALSE(alike_but_for_leaves(ball, other));
  other = ball;
  other.transform.translation[1] += 1;
  EXPECT_FALSE(alike_but_for_leaves(ball, other));
  other = ball;
  other.regions.pop_back();
  EXPECT_FALSE(alike_but_for_leaves(ball, other));
  other = ball;
  other.cubes.push_back({{0, 0, 0}, 128, 1});
  EXPECT_FALSE(alike_but_for_leaves(ball, other));
  EXPECT_TRUE(alike_but_for_leaves(ball, ball));
}

}  // namespace
}  // namespace tet
