#include "core/scene/grid_scene.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "core/scene/scene_evaluator.h"
#include "core/volume/check_transform.h"
#include "core/volume/to_voxel.h"
#include "core/volume/volume_builder.h"
#include "tests/support/nearly_cubic.h"
#include "tests/support/volume_fixtures.h"

namespace tet {
namespace {

VoxelTransform skewed() {
  VoxelTransform transform;
  transform.linear = {{{0.5, 0.2, 0}, {-0.1, 0.6, 0.3}, {0, 0, -1.5}}};
  transform.translation = {3, -40, 11};
  transform.voxel_size = voxel_edge(transform);
  return transform;
}

std::shared_ptr<const Volume> ball_of(const VoxelTransform& transform) {
  VolumeBuilder builder(VolumeKind::kLevelSet, 5, transform);
  for (std::int32_t i = 0; i < 64; ++i) {
    const BrickCoord brick{i / 16 - 2, i / 4 % 4 - 2, i % 4 - 2};
    std::array<float, kBrickCells> values;
    for (int v = 0; v < kBrickCells; ++v) {
      const int x = 8 * brick.x + v / 64, y = 8 * brick.y + v / 8 % 8, z = 8 * brick.z + v % 8;
      const double radius =
          std::hypot(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z));
      values[static_cast<std::size_t>(v)] = static_cast<float>(std::min(5.0, radius - 9));
    }
    builder.add_brick(brick, values);
  }
  return std::make_shared<const Volume>(*std::move(builder).build());
}

TEST(GridScene, HasTheValuesOfItsVoxelsWhereTheseLie) {
  const auto volume = ball_of(skewed());
  ASSERT_FALSE(has_cubic_voxels(volume->transform));
  const Scene scene = scene_of_grid(volume, 0.25F, InsideSide::kBelow);
  SceneEvaluator evaluator(scene);
  VolumeReader reader(*volume);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> anywhere(-18, 18);
  for (int i = 0; i < 1000; ++i) {
    const VoxelPoint voxel{anywhere(random), anywhere(random), anywhere(random)};
    const double phi = evaluator.at(volume->transform.to_world(voxel));
    EXPECT_NEAR(phi, reader.trilinear(voxel) - 0.25, 1e-9);
  }
}

TEST(GridScene, HasTheValuesOfItsVoxelsFarOutWhereTheseAreNearlyCubic) {
  const VoxelCoord at = test::kFarVoxel;
  const auto value = [&](VoxelCoord v) {
    return static_cast<float>(0.25 * (v.x - at.x) - 0.5 * (v.y - at.y) + (v.z - at.z));
  };
  const auto volume = std::make_shared<const Volume>(
      test::dense_volume({{at.x - 8, at.y - 8, at.z - 8}, {at.x + 8, at.y + 8, at.z + 8}}, 20,
                         value, test::nearly_cubic()));
  const Scene scene = scene_of_grid(volume, 0, InsideSide::kBelow);
  SceneEvaluator evaluator(scene);
  VolumeReader reader(*volume);
  const VoxelPoint voxel{at.x + 1.25, at.y - 2.0, at.z + 0.5};
  EXPECT_NEAR(evaluator.at(volume->transform.to_world(voxel)), reader.trilinear(voxel), 1e-6);
}

TEST(GridScene, ReachesAsFarAsItsInside) {
  const auto volume = ball_of(skewed());
  const Scene scene = scene_of_grid(volume, 0, InsideSide::kBelow);
  EXPECT_TRUE(scene.ends());
  std::mt19937 random(4);
  std::uniform_real_distribution<double> anywhere(-18, 18);
  for (int i = 0; i < 1000; ++i) {
    const VoxelPoint voxel{anywhere(random), anywhere(random), anywhere(random)};
    if (std::hypot(voxel.x, voxel.y, voxel.z) > 9) continue;
    const WorldPoint p = volume->transform.to_world(voxel);
    EXPECT_TRUE(p.x >= scene.extent.min.x && p.x <= scene.extent.max.x);
    EXPECT_TRUE(p.y >= scene.extent.min.y && p.y <= scene.extent.max.y);
    EXPECT_TRUE(p.z >= scene.extent.min.z && p.z <= scene.extent.max.z);
  }
}

TEST(GridScene, OfNothingInsideIsEmpty) {
  const Scene scene = scene_of_grid(ball_of(skewed()), -50, InsideSide::kBelow);
  EXPECT_GT(scene.extent.min.x, scene.extent.max.x);
}

TEST(GridScene, LeadsBackFromTheWorld) {
  const VoxelTransform transform = skewed();
  const VoxelPoint there = to_voxel(transform, transform.to_world({4, -7, 9.5}));
  EXPECT_NEAR(there.x, 4, 1e-12);
  EXPECT_NEAR(there.y, -7, 1e-12);
  EXPECT_NEAR(there.z, 9.5, 1e-12);
}

}  // namespace
}  // namespace tet
