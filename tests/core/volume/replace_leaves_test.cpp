#include "core/volume/replace_leaves.h"

#include <array>
#include <limits>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/parallel.h"
#include "core/volume/volume_builder.h"
#include "core/volume/volume_reader.h"
#include "tests/support/solids.h"

namespace tet {
namespace {

using testing::HasSubstr;

constexpr std::array<float, 1> kInside{-2};
const std::vector<float> kSeven(kBrickCells, 7.0F);

/// One value of every brick in [-40, 40)^3 and around.
std::vector<float> samples(const Volume& volume) {
  VolumeReader reader(volume);
  std::vector<float> values;
  for (std::int32_t x = -42; x < 42; ++x) {
    for (std::int32_t y = -42; y < 42; ++y) {
      for (std::int32_t z = -42; z < 42; ++z) {
        values.push_back(reader.value({8 * x + 3, 8 * y + 1, 8 * z + 6}));
      }
    }
  }
  return values;
}

/// Differs from `before` in this many places, and there has these values.
void expect_replaced(const Volume& before, const std::vector<LeafValues>& leaves) {
  const absl::StatusOr<Volume> after = replace_leaves(before, leaves);
  ASSERT_TRUE(after.ok()) << after.status();
  EXPECT_LE(after->size_bytes(), most_bytes_with(before, leaves));
  VolumeReader reader(*after);
  for (const LeafValues& leaf : leaves) {
    const VoxelCoord voxel{8 * leaf.brick.x + 7, 8 * leaf.brick.y, 8 * leaf.brick.z + 2};
    const std::size_t at = leaf.values.size() == 1 ? 0 : 7 * 64 + 2;
    EXPECT_EQ(reader.value(voxel), leaf.values[at]);
  }
  const std::vector<float> a = samples(before), b = samples(*after);
  std::size_t changed = 0;
  for (std::size_t i = 0; i < a.size(); ++i) changed += a[i] != b[i];
  EXPECT_EQ(changed, leaves.size());
}

TEST(ReplaceLeaves, ReplacesStoredConstantAndMissingLeaves) {
  const Volume ball = test::ball(30);
  const BrickCoord stored = ball.bricks[ball.bricks.size() / 2];
  expect_replaced(ball, {{stored, kSeven},
                         {{40, 2, -9}, kSeven},
                         {{-41, -41, -41}, kInside},
                         {{0, 0, 0}, kSeven}});
  expect_replaced(ball, {{stored, kInside}});
}

TEST(ReplaceLeaves, DividesTheCubesThatALeafLiesIn) {
  VolumeBuilder builder(VolumeKind::kLevelSet, 3);
  builder.add_constant_cube({128, 0, 0}, 128, -3);
  builder.add_constant_cube({-4096, 0, 0}, 4096, -3);
  const Volume volume = std::move(builder).build().value();
  expect_replaced(volume,
                  {{{16, 0, 15}, kSeven}, {{-1, 0, 0}, kInside}, {{-20, 40, 3}, kSeven}});
}

TEST(ReplaceLeaves, IsTheSameTwiceAndChangesNothingWithNothing) {
  const Volume ball = test::ball(12);
  const Volume same = replace_leaves(ball, {}).value();
  EXPECT_EQ(same.bricks, ball.bricks);
  EXPECT_EQ(same.values, ball.values);
  EXPECT_EQ(samples(same), samples(ball));
}

TEST(ReplaceLeaves, TakesMemoryThatIsKnownBefore) {
  const Volume ball = test::ball(20);
  std::vector<LeafValues> scattered;
  for (std::int32_t i = 1; i <= 100; ++i) scattered.push_back({{16 * i, 0, 16 * i}, kInside});
  const std::uint64_t most = most_bytes_with(ball, scattered);
  const auto after = replace_leaves(ball, scattered);
  ASSERT_TRUE(after.ok()) << after.status();
  EXPECT_GT(after->size_bytes(), 100 * sizeof(Region));
  EXPECT_LE(after->size_bytes(), most);
  EXPECT_LT(most, 2 * after->size_bytes());
}

TEST(ReplaceLeaves, EndWhereverTheyAreCancelled) {
  const Volume ball = test::ball(60);
  int looks = 0, last = std::numeric_limits<int>::max();
  const auto replace = [&] {
    looks = 0;
    const Cancellation cancellation(Cancellation::Clock::time_point::max(),
                                    [&] { return ++looks >= last; });
    absl::Status status;
    TaskPool(1).run([&] {
      status = replace_leaves(ball, {{{0, 0, 0}, kSeven}}, cancellation).status();
    });
    return status;
  };
  ASSERT_EQ(replace(), absl::OkStatus());
  const int all = looks;
  ASSERT_GT(all, 8) << "several among bricks, ranges and regions";
  for (last = 1; last <= all; ++last) {
    EXPECT_EQ(replace().code(), absl::StatusCode::kCancelled) << last;
  }
}

TEST(ReplaceLeaves, RefusesLeavesThatAreNone) {
  const Volume ball = test::ball(12);
  const auto refusal = [&](std::vector<LeafValues> leaves) {
    return std::string(replace_leaves(ball, std::move(leaves)).status().message());
  };
  const std::vector<float> two(2), poison{std::numeric_limits<float>::quiet_NaN()};
  EXPECT_THAT(refusal({{{1, 2, 3}, two}}), HasSubstr("has 2 values; a leaf has 512, or 1"));
  EXPECT_THAT(refusal({{{1, 2, 3}, kSeven}, {{1, 2, 3}, kInside}}),
              HasSubstr("is given twice"));
  EXPECT_THAT(refusal({{{1, 2, 3}, poison}}), HasSubstr("must be finite"));
  EXPECT_THAT(refusal({{{1 << 27, 2, 3}, kInside}}), HasSubstr("beyond the limit"));
}

}  // namespace
}  // namespace tet
