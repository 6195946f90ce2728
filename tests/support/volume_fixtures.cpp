#include "tests/support/volume_fixtures.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <utility>
#include <vector>

#include "core/volume/volume_builder.h"

namespace tet::test {
namespace {

using BrickValues = std::array<float, kBrickCells>;

/// Calls `visit(brick)` for every brick that meets the box.
template <class Visit>
void for_each_brick(const VoxelBox& box, const Visit& visit) {
  for (int x = box.min.x >> 3; x <= box.max.x >> 3; ++x) {
    for (int y = box.min.y >> 3; y <= box.max.y >> 3; ++y) {
      for (int z = box.min.z >> 3; z <= box.max.z >> 3; ++z) visit(BrickCoord{x, y, z});
    }
  }
}

bool contains(const VoxelBox& box, VoxelCoord v) {
  return v.x >= box.min.x && v.x <= box.max.x && v.y >= box.min.y && v.y <= box.max.y &&
         v.z >= box.min.z && v.z <= box.max.z;
}

BrickValues evaluate(const VoxelBox& box,
                     BrickCoord brick,
                     float background,
                     const VoxelFunction& value) {
  BrickValues values;
  for (int i = 0; i < kBrickCells; ++i) {
    const VoxelCoord voxel{brick.x * 8 + i / 64, brick.y * 8 + i / 8 % 8, brick.z * 8 + i % 8};
    values[static_cast<std::size_t>(i)] = contains(box, voxel) ? value(voxel) : background;
  }
  return values;
}

Volume built(VolumeBuilder builder) {
  absl::StatusOr<Volume> volume = std::move(builder).build();
  if (volume.ok()) return *std::move(volume);
  std::fprintf(stderr, "bad test volume: %s\n", volume.status().ToString().c_str());
  std::abort();
}

/// Constant bricks by the 16^3 of them that they belong to.
using ConstantBricks = std::map<BrickCoord, std::vector<BrickCoord>>;

void add_constants(VolumeBuilder& builder, const ConstantBricks& constants, float value) {
  for (const auto& [region, bricks] : constants) {
    if (bricks.size() == Region::kEdgeBricks * Region::kEdgeBricks * Region::kEdgeBricks) {
      builder.add_constant_cube({region.x * 8, region.y * 8, region.z * 8}, 128, value);
    } else {
      for (const BrickCoord brick : bricks) builder.add_constant_brick(brick, value);
    }
  }
}

}  // namespace

Volume dense_volume(const VoxelBox& box,
                    float background,
                    const VoxelFunction& value,
                    const VoxelTransform& transform) {
  VolumeBuilder builder(VolumeKind::kLevelSet, background, transform);
  for_each_brick(box, [&](BrickCoord brick) {
    builder.add_brick(brick, evaluate(box, brick, background, value));
  });
  return built(std::move(builder));
}

Volume narrow_band_volume(const VoxelBox& box,
                          float background,
                          const VoxelFunction& value,
                          const VoxelTransform& transform) {
  VolumeBuilder builder(VolumeKind::kLevelSet, background, transform);
  ConstantBricks inside;
  for_each_brick(box, [&](BrickCoord brick) {
    BrickValues values = evaluate(box, brick, background, value);
    for (float& v : values) v = std::clamp(v, -background, background);
    const auto [min, max] = std::minmax_element(values.begin(), values.end());
    if (*min == background) return;
    if (*max == -background) {
      inside[{brick.x & ~15, brick.y & ~15, brick.z & ~15}].push_back(brick);
    } else {
      builder.add_brick(brick, values);
    }
  });
  add_constants(builder, inside, -background);
  return built(std::move(builder));
}

VoxelTransform scaled(double voxel_size) {
  VoxelTransform transform;
  for (std::size_t i = 0; i < 3; ++i) transform.linear[i][i] = voxel_size;
  transform.voxel_size = voxel_size;
  return transform;
}

}  // namespace tet::test
