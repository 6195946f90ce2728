#include "core/volume/volume_builder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/volume/volume_reader.h"
#include "tests/support/volume_fixtures.h"

namespace tet {
namespace {

using ::testing::HasSubstr;

std::array<float, kBrickCells> filled(float value) {
  std::array<float, kBrickCells> values;
  values.fill(value);
  return values;
}

VolumeBuilder level_set_builder() { return {VolumeKind::kLevelSet, 3.0F}; }

TEST(VolumeBuilder, TakesBricksInAnyOrder) {
  VolumeBuilder builder = level_set_builder();
  auto last = filled(2);
  last[(7 * 8 + 1) * 8 + 2] = -1;
  builder.add_brick({1, -2, 30}, last);
  builder.add_brick({-1, 0, 0}, filled(1));
  const absl::StatusOr<Volume> volume = std::move(builder).build();
  ASSERT_TRUE(volume.ok()) << volume.status();
  EXPECT_EQ(volume->bricks, (std::vector<BrickCoord>{{-1, 0, 0}, {1, -2, 30}}));
  EXPECT_EQ(volume->ranges[1].min, -1);
  EXPECT_EQ(volume->ranges[1].max, 2);
  VolumeReader reader(*volume);
  EXPECT_EQ(reader.value({8 + 7, -16 + 1, 240 + 2}), -1);
  EXPECT_EQ(reader.value({-1, 0, 0}), 1);
  EXPECT_EQ(reader.value({500, 0, 0}), 3);
}

TEST(VolumeBuilder, KeepsConstantsApartFromValues) {
  VolumeBuilder builder = level_set_builder();
  builder.add_brick({0, 0, 0}, filled(1));
  builder.add_constant_brick({0, 0, 1}, -3);
  builder.add_constant_cube({-128, 0, 0}, 128, -3);
  builder.add_constant_cube({0, 4096, -4096}, 4096, 5);
  const absl::StatusOr<Volume> volume = std::move(builder).build();
  ASSERT_TRUE(volume.ok()) << volume.status();
  VolumeReader reader(*volume);
  EXPECT_EQ(reader.value({0, 0, 15}), -3);
  EXPECT_EQ(reader.value({0, 0, 16}), 3);
  EXPECT_EQ(reader.value({-1, 127, 127}), -3);
  EXPECT_EQ(reader.value({4095, 8191, -1}), 5);
  EXPECT_EQ(reader.value({4096, 8191, -1}), 3);
}

TEST(VolumeBuilder, NamesTheVoxelThatIsNotFinite) {
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
        -std::numeric_limits<float>::infinity()}) {
    VolumeBuilder builder = level_set_builder();
    builder.add_brick({0, 0, 0}, filled(1));
    auto values = filled(2);
    values[(1 * 8 + 2) * 8 + 3] = bad;
    builder.add_brick({1, 1, -1}, values);
    const absl::StatusOr<Volume> volume = std::move(builder).build();
    EXPECT_EQ(volume.status().code(), absl::StatusCode::kFailedPrecondition);
    EXPECT_THAT(volume.status().message(), HasSubstr("voxel (9, 10, -5)"));
  }
}

TEST(VolumeBuilder, RefusesConstantsThatAreNotFinite) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  VolumeBuilder brick = level_set_builder();
  brick.add_constant_brick({0, 0, 2}, nan);
  EXPECT_THAT(std::move(brick).build().status().message(), HasSubstr("(0, 0, 16)"));
  VolumeBuilder cube = level_set_builder();
  cube.add_constant_cube({0, 128, 0}, 128, nan);
  EXPECT_THAT(std::move(cube).build().status().message(), HasSubstr("(0, 128, 0)"));
  VolumeBuilder background(VolumeKind::kLevelSet, nan);
  EXPECT_THAT(std::move(background).build().status().message(), HasSubstr("background"));
}

TEST(VolumeBuilder, RefusesCoordinatesBeyondTheLimit) {
  constexpr std::int32_t kLast = kMaxVoxelCoord / 8;
  VolumeBuilder good = level_set_builder();
  good.add_brick({kLast - 1, -kLast, 0}, filled(1));
  EXPECT_TRUE(std::move(good).build().ok());
  VolumeBuilder high = level_set_builder();
  high.add_brick({0, kLast, 0}, filled(1));
  EXPECT_THAT(std::move(high).build().status().message(),
              HasSubstr("voxel coordinate 536870919 is beyond the limit of 536870912"));
  VolumeBuilder low = level_set_builder();
  low.add_brick({0, 0, -kLast - 1}, filled(1));
  EXPECT_THAT(std::move(low).build().status().message(), HasSubstr("-536870920"));
}

TEST(VolumeBuilder, RefusesTwoThingsInOnePlace) {
  VolumeBuilder bricks = level_set_builder();
  bricks.add_brick({0, 0, 0}, filled(1));
  bricks.add_brick({0, 0, 0}, filled(2));
  EXPECT_EQ(std::move(bricks).build().status().code(), absl::StatusCode::kInvalidArgument);
  VolumeBuilder constant = level_set_builder();
  constant.add_brick({0, 0, 0}, filled(1));
  constant.add_constant_brick({0, 0, 0}, 2);
  EXPECT_EQ(std::move(constant).build().status().code(), absl::StatusCode::kInvalidArgument);
  VolumeBuilder cube = level_set_builder();
  cube.add_brick({3, 3, 3}, filled(1));
  cube.add_constant_cube({0, 0, 0}, 4096, 2);
  EXPECT_EQ(std::move(cube).build().status().code(), absl::StatusCode::kInvalidArgument);
  VolumeBuilder cubes = level_set_builder();
  cubes.add_constant_cube({0, 0, 0}, 4096, 2);
  cubes.add_constant_cube({128, 128, 0}, 128, 2);
  EXPECT_EQ(std::move(cubes).build().status().code(), absl::StatusCode::kInvalidArgument);
}

TEST(VolumeBuilder, RefusesCubesOffTheirGrid) {
  VolumeBuilder moved = level_set_builder();
  moved.add_constant_cube({64, 0, 0}, 128, 2);
  EXPECT_THAT(std::move(moved).build().status().message(), HasSubstr("not aligned"));
  VolumeBuilder odd = level_set_builder();
  odd.add_constant_cube({0, 0, 0}, 64, 2);
  EXPECT_THAT(std::move(odd).build().status().message(), HasSubstr("64"));
}

TEST(VoxelTransform, KnowsAMirror) {
  VoxelTransform transform = test::scaled(0.5);
  EXPECT_FALSE(transform.mirrors());
  transform.linear[1][1] = -0.5;
  EXPECT_TRUE(transform.mirrors());
}

TEST(VolumeFixtures, NarrowBandReadsAsTheClampedFunction) {
  const auto ball = [](VoxelCoord v) {
    return static_cast<float>(std::hypot(v.x - 64, v.y - 60, v.z + 64)) - 120.0F;
  };
  const VoxelBox box{{-60, -64, -188}, {188, 184, 60}};
  const Volume volume = test::narrow_band_volume(box, 3, ball);
  EXPECT_GT(volume.cubes.size(), 0U);
  EXPECT_LT(volume.size_bytes(), test::dense_volume(box, 3, ball).size_bytes() / 3);
  VolumeReader reader(volume);
  for (int x = -60; x < 190; x += 7) {
    for (int y = -70; y < 190; y += 7) {
      for (int z = -190; z < 60; z += 3) {
        EXPECT_EQ(reader.value({x, y, z}), std::clamp(ball({x, y, z}), -3.0F, 3.0F));
      }
    }
  }
}

}  // namespace
}  // namespace tet
