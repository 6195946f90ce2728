#include "core/volume/value_bounds.h"

#include <algorithm>
#include <array>
#include <limits>
#include <random>
#include <utility>

#include <gtest/gtest.h>

#include "core/volume/value_box.h"
#include "core/volume/volume_builder.h"

namespace tet {
namespace {

/// Bricks here and there, constants beside them, and cubes of both sizes, whose values tell
/// where they are.
Volume scattered_volume() {
  VolumeBuilder builder(VolumeKind::kLevelSet, 3);
  std::mt19937 random(1);
  const auto below = [&](std::uint32_t n) { return static_cast<std::int32_t>(random() % n); };
  for (std::int32_t i = 0; i < 60; ++i) {
    const BrickCoord at{16 * (i % 5) + below(16) - 40, below(60) - 30, i};
    std::array<float, kBrickCells> values;
    for (float& value : values) value = static_cast<float>(below(1000)) / 100 - 5;
    i % 4 == 0 ? builder.add_constant_brick(at, -1.5F) : builder.add_brick(at, values);
  }
  builder.add_constant_cube({128 * 9, 0, 0}, 128, -7);
  builder.add_constant_cube({4096, -4096, 0}, 4096, -20);
  builder.add_constant_cube({-(1 << 28), 0, 1 << 28}, 4096, 30);
  return *std::move(builder).build();
}

/// A box of up to `edge` voxels along each axis, about the bricks.
VoxelBox random_box(std::mt19937& random, std::int32_t edge) {
  const auto below = [&](std::int32_t n) {
    return static_cast<std::int32_t>(random() % static_cast<std::uint32_t>(n));
  };
  const VoxelCoord min{below(1200) - 500, below(600) - 300, below(600) - 60};
  return {min, {min.x + below(edge), min.y + below(edge), min.z + below(edge)}};
}

TEST(ValueBounds, HoldEveryValueInABoxAndAreExactInSmallOnes) {
  const Volume volume = scattered_volume();
  const ValueBounds bounds(volume);
  VolumeReader reader(volume);
  std::mt19937 random(2);
  for (int i = 0; i < 400; ++i) {
    const VoxelBox box = random_box(random, i % 2 == 0 ? 8 : 90);
    const auto [min, max] = bounds.within(reader, box);
    float least = std::numeric_limits<float>::max(), most = -least;
    const std::int32_t step = i % 2 == 0 ? 1 : 3;
    for (std::int32_t x = box.min.x; x <= box.max.x; x += step) {
      for (std::int32_t y = box.min.y; y <= box.max.y; y += step) {
        for (std::int32_t z = box.min.z; z <= box.max.z; z += step) {
          least = std::min(least, reader.value({x, y, z}));
          most = std::max(most, reader.value({x, y, z}));
        }
      }
    }
    ASSERT_LE(min, least);
    ASSERT_GE(max, most);
    if (step == 1) {
      ASSERT_EQ(std::pair(min, max), std::pair(least, most));
    }
  }
}

TEST(ValueBounds, AreTheConstantDeepInACube) {
  const Volume volume = scattered_volume();
  const ValueBounds bounds(volume);
  VolumeReader reader(volume);
  const auto range = [&](std::int32_t min, std::int32_t edge) {
    const auto [low, high] = bounds.within(
        reader,
        {{min + 4096, min - 4096, min}, {min + 4096 + edge, min - 4096 + edge, min + edge}});
    return std::pair(low, high);
  };
  EXPECT_EQ(range(1, 3), std::pair(-20.0F, -20.0F));
  EXPECT_EQ(range(100, 100), std::pair(-20.0F, -20.0F));
  EXPECT_EQ(range(1000, 3000), std::pair(-20.0F, -20.0F));
  EXPECT_EQ(range(100, 5000), std::pair(-20.0F, 3.0F));
}

TEST(ValueBounds, CoverAllOfIndexSpace) {
  const Volume volume = scattered_volume();
  const ValueBounds bounds(volume);
  VolumeReader reader(volume);
  constexpr std::int32_t kEnd = 1 << 30;
  const auto [min, max] = bounds.within(reader, {{-kEnd, -kEnd, -kEnd}, {kEnd, kEnd, kEnd}});
  EXPECT_EQ(std::pair(min, max), std::pair(-20.0F, 30.0F));
  EXPECT_EQ(std::pair(bounds.all().min, bounds.all().max), std::pair(-20.0F, 30.0F));
  const auto far = bounds.within(reader, {{kEnd / 2, 0, 0}, {kEnd, 10000, 10000}});
  EXPECT_EQ(std::pair(far.min, far.max), std::pair(3.0F, 3.0F));
}

TEST(ValueBox, IsTightAroundWantedValues) {
  VolumeBuilder builder(VolumeKind::kLevelSet, 3);
  std::array<float, kBrickCells> values;
  values.fill(1);
  values[(2 * 8 + 3) * 8 + 4] = -1;
  values[(5 * 8 + 6) * 8 + 7] = -0.25;
  builder.add_brick({-1, 0, 2}, values);
  builder.add_constant_brick({3, 0, 0}, -3);
  const Volume volume = *std::move(builder).build();
  constexpr double kInf = std::numeric_limits<double>::infinity();
  const auto box = [&](const WantedValues& wanted) { return box_of_values(volume, wanted); };
  EXPECT_EQ(box({-2, 0}).min, (VoxelCoord{-6, 3, 20}));
  EXPECT_EQ(box({-2, 0}).max, (VoxelCoord{-3, 6, 23}));
  EXPECT_EQ(box({-2, -0.25}).max, (VoxelCoord{-6, 3, 20})) << "both ends are left out";
  EXPECT_EQ(box({-kInf, 0}).max, (VoxelCoord{31, 7, 23}));
  EXPECT_TRUE(box({1, 3}).empty());
}

}  // namespace
}  // namespace tet
