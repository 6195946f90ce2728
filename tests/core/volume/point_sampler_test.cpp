#include "core/volume/point_sampler.h"

#include <array>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "core/volume/volume_builder.h"
#include "tests/support/nearly_cubic.h"
#include "tests/support/volume_fixtures.h"

namespace tet {
namespace {

std::vector<std::shared_ptr<const Volume>> shared(std::vector<Volume> volumes) {
  std::vector<std::shared_ptr<const Volume>> components;
  for (Volume& volume : volumes) {
    components.push_back(std::make_shared<const Volume>(std::move(volume)));
  }
  return components;
}

/// Random values in [-20, 20]^3 voxels, and beyond them a constant brick, a cube and 3.
Volume random_values(unsigned seed, const VoxelTransform& transform = {}) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> any(-1, 1);
  VolumeBuilder builder(VolumeKind::kField, 3, transform);
  for (int x = -3; x < 3; ++x) {
    for (int y = -3; y < 3; ++y) {
      for (int z = -3; z < 3; ++z) {
        std::array<float, kBrickCells> values;
        for (float& value : values) value = any(random);
        builder.add_brick({x, y, z}, values);
      }
    }
  }
  builder.add_constant_brick({3, 0, 0}, 0.25F);
  builder.add_constant_cube({128, 0, 0}, 128, 5);
  return *std::move(builder).build();
}

std::vector<float> sampled(PointSampler& sampler, const std::vector<WorldPoint>& points) {
  std::vector<float> values(points.size() * sampler.components());
  PointSampler::Points some;
  const auto workspace = std::make_unique<PointSampler::Workspace>();
  for (std::size_t first = 0; first < points.size(); first += some.count) {
    some.count = std::min(points.size() - first, PointSampler::kMaxPoints);
    for (std::size_t i = 0; i < some.count; ++i) {
      const auto [x, y, z] = points[first + i];
      some.at[0][i] = x;
      some.at[1][i] = y;
      some.at[2][i] = z;
    }
    sampler.sample(some, *workspace, &values[first * sampler.components()],
                   sampler.components());
  }
  return values;
}

TEST(PointSampler, InterpolatesBetweenEightVoxelsAsAReaderDoes) {
  const auto volumes = shared({random_values(1), random_values(2), random_values(3)});
  std::mt19937 random(4);
  std::uniform_real_distribution<double> any(-40, 160);
  std::vector<WorldPoint> points;
  for (int i = 0; i < 3000; ++i) points.push_back({any(random), any(random), any(random)});
  for (int i = 0; i < 3000; ++i) {
    points.push_back({any(random) / 8, any(random) / 8, any(random) / 8});
  }
  // Points follow each other as those of a mesh do, and go beyond the bricks with values.
  for (int i = 0; i < 4096; ++i) {
    const int x = i / 256, y = i / 16 % 16, z = i % 16;
    points.push_back({18.3 + 0.7 * x, -4.1 + 0.7 * y, 0.7 * z});
  }
  PointSampler sampler(volumes);
  const std::vector<float> values = sampled(sampler, points);
  for (std::size_t c = 0; c < 3; ++c) {
    VolumeReader reader(*volumes[c]);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto [x, y, z] = points[i];
      EXPECT_EQ(values[3 * i + c], static_cast<float>(reader.trilinear({x, y, z})));
    }
  }
}

/// Turned by asin(0.6) about z, mirrored, and moved.
VoxelTransform turned(double voxel) {
  VoxelTransform transform;
  transform.linear = {
      {{0.8 * voxel, 0.6 * voxel, 0}, {0.6 * voxel, -0.8 * voxel, 0}, {0, 0, voxel}}};
  transform.translation = {10.25, -3.5, 0.125};
  transform.voxel_size = voxel;
  return transform;
}

TEST(PointSampler, FindsTheVoxelsFarOutInAGridThatIsNearlyCubic) {
  const VoxelCoord at = test::kFarVoxel;
  const auto value = [&](VoxelCoord v) {
    return static_cast<float>(0.25 * (v.x - at.x) - 0.5 * (v.y - at.y) + (v.z - at.z));
  };
  const VoxelTransform transform = test::nearly_cubic();
  const auto volumes = shared({test::dense_volume(
      {{at.x - 8, at.y - 8, at.z - 8}, {at.x + 8, at.y + 8, at.z + 8}}, 0, value, transform)});
  PointSampler sampler(volumes);
  const WorldPoint p = transform.to_world({at.x + 1.25, at.y - 2.0, at.z + 0.5});
  EXPECT_NEAR(sampled(sampler, {p})[0], 0.25 * 1.25 + 0.5 * 2 + 0.5, 1e-5);
}

TEST(PointSampler, ReproducesALinearFunctionWhereverTheVoxelsLie) {
  const VoxelTransform transform = turned(0.3);
  const auto linear = [](const WorldPoint& p) { return 1 + 2 * p.x - 3 * p.y + 0.5 * p.z; };
  const auto value = [&](VoxelCoord v) {
    return static_cast<float>(
        linear(transform.to_world({double(v.x), double(v.y), double(v.z)})));
  };
  const VoxelBox box{{-20, -20, -20}, {20, 20, 20}};
  const auto volumes = shared({test::dense_volume(box, 0, value, transform)});
  PointSampler sampler(volumes);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-19, 19);
  std::vector<WorldPoint> points;
  for (int i = 0; i < 1000; ++i) {
    points.push_back(transform.to_world({any(random), any(random), any(random)}));
  }
  const std::vector<float> values = sampled(sampler, points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double exact = linear(points[i]);
    // The voxels' values are rounded, and so is the result.
    EXPECT_NEAR(values[i], exact, 60 * std::numeric_limits<float>::epsilon());
  }
}

TEST(PointSampler, IsTheBackgroundWhereNothingIsHoweverFar) {
  const auto volumes = shared({random_values(6, turned(1e-3))});
  PointSampler sampler(volumes);
  const double inf = std::numeric_limits<double>::infinity();
  const std::vector<WorldPoint> points{
      {1e3, 0, 0}, {-1e30, 1e30, 1e30}, {inf, -inf, inf}, {0, 0, 1e300}, {1e300, 1e300, -inf}};
  for (const float value : sampled(sampler, points)) EXPECT_EQ(value, 3);
}

}  // namespace
}  // namespace tet
