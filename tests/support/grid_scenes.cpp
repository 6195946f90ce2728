#include "tests/support/grid_scenes.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "tests/support/volume_fixtures.h"

namespace tet::test {
namespace {

VoxelTransform transform_of(const BallGrid& ball) {
  VoxelTransform transform = scaled(ball.voxel);
  if (ball.turned) {
    // x to y, y to z, z to x.
    transform.linear = {{{0, 0, ball.voxel}, {ball.voxel, 0, 0}, {0, ball.voxel, 0}}};
  }
  if (ball.shifted) transform.translation.fill(ball.voxel / 2);
  return transform;
}

VoxelBox box_of(const BallGrid& ball) {
  const auto reach = static_cast<std::int32_t>(ball.radius / ball.voxel + ball.band + 2);
  return {{-reach, -reach, -reach}, {reach, reach, reach}};
}

/// World units from the surface, negative inside.
double distance(const BallGrid& ball, const VoxelTransform& transform, VoxelCoord v) {
  const WorldPoint p = transform.to_world(
      {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)});
  const auto& [x, y, z] = ball.centre;
  return std::hypot(p.x - x, p.y - y, p.z - z) - ball.radius;
}

std::shared_ptr<const Volume> shared(Volume volume) {
  return std::make_shared<const Volume>(std::move(volume));
}

}  // namespace

std::shared_ptr<const Volume> grid_of(const BallGrid& ball) {
  const VoxelTransform transform = transform_of(ball);
  const auto background = static_cast<float>(ball.band * ball.voxel);
  const auto value = [&](VoxelCoord v) {
    return static_cast<float>(distance(ball, transform, v));
  };
  return shared(narrow_band_volume(box_of(ball), background, value, transform));
}

std::shared_ptr<const Volume> fog_of(const BallGrid& ball) {
  const VoxelTransform transform = transform_of(ball);
  const auto density = [&](VoxelCoord v) {
    const double steps = distance(ball, transform, v) / (ball.band * ball.voxel);
    return static_cast<float>(std::clamp(0.5 - steps / 2, 0.0, 1.0));
  };
  Volume volume = dense_volume(box_of(ball), 0, density, transform);
  volume.kind = VolumeKind::kFogVolume;
  return shared(std::move(volume));
}

std::shared_ptr<const Volume> random_grid(std::uint32_t seed) {
  std::mt19937 random(seed);
  VoxelTransform transform = scaled(0.1);
  transform.translation.fill(0.03 * static_cast<double>(random() % 4));
  const auto value = [&](VoxelCoord) {
    return static_cast<float>(random()) / 2147483648.0F - 1;
  };
  return shared(dense_volume({{-12, -12, -12}, {12, 12, 12}}, 1.5F, value, transform));
}

scene::GridSolid leaf(std::shared_ptr<const Volume> volume) {
  return {"a.vdb", volume->name, {}, std::move(volume)};
}

}  // namespace tet::test
