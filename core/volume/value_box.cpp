#include "core/volume/value_box.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "core/base/brick_mask.h"

namespace tet {
namespace {

/// A box that grows by cubes of voxels.
class GrowingBox {
 public:
  bool holds(const VoxelCoord& min, std::int32_t edge) const noexcept {
    const std::int32_t last = edge - 1;
    return min.x >= box_.min.x && min.y >= box_.min.y && min.z >= box_.min.z &&
           min.x + last <= box_.max.x && min.y + last <= box_.max.y &&
           min.z + last <= box_.max.z;
  }
  void add(const VoxelCoord& min, std::int32_t edge) noexcept {
    const std::int32_t last = edge - 1;
    box_.min = {std::min(box_.min.x, min.x), std::min(box_.min.y, min.y),
                std::min(box_.min.z, min.z)};
    box_.max = {std::max(box_.max.x, min.x + last), std::max(box_.max.y, min.y + last),
                std::max(box_.max.z, min.z + last)};
  }
  const VoxelBox& box() const noexcept { return box_; }

 private:
  VoxelBox box_{{INT32_MAX, INT32_MAX, INT32_MAX}, {INT32_MIN, INT32_MIN, INT32_MIN}};
};

VoxelCoord first_voxel(const BrickCoord& brick) noexcept {
  return {kBrickEdge * brick.x, kBrickEdge * brick.y, kBrickEdge * brick.z};
}

void add_bricks(const Volume& volume, const WantedValues& wanted, GrowingBox& box) {
  for (std::size_t i = 0; i < volume.bricks.size(); ++i) {
    const VoxelCoord min = first_voxel(volume.bricks[i]);
    const auto [least, most] = volume.ranges[i];
    const bool any =
        static_cast<double>(most) > wanted.above && static_cast<double>(least) < wanted.below;
    if (!any || box.holds(min, kBrickEdge)) continue;
    const float* value = volume.values.data() + i * kBrickCells;
    for_each_bit(BrickMask::all(), [&](int x, int y, int z) {
      if (wanted.have(*value++)) box.add({min.x + x, min.y + y, min.z + z}, 1);
    });
  }
}

void add_constants(const Volume& volume, const WantedValues& wanted, GrowingBox& box) {
  constexpr int kRegionEdge = Region::kEdgeBricks;
  for (const ConstantCube& cube : volume.cubes) {
    if (wanted.have(cube.value)) box.add(cube.min, cube.edge);
  }
  for (const Region& region : volume.regions) {
    if (box.holds(first_voxel(region.min), kRegionEdge * kBrickEdge)) continue;
    for (int i = 0; i < kRegionEdge * kRegionEdge * kRegionEdge; ++i) {
      const auto at = static_cast<std::size_t>(i);
      if (region.brick_index[at] != Region::kConstant || !wanted.have(region.constant[at]) ||
          region.constant[at] == volume.background) {
        continue;
      }
      const BrickCoord brick{region.min.x + i / (kRegionEdge * kRegionEdge),
                             region.min.y + i / kRegionEdge % kRegionEdge,
                             region.min.z + i % kRegionEdge};
      box.add(first_voxel(brick), kBrickEdge);
    }
  }
}

}  // namespace

VoxelBox box_of_values(const Volume& volume, const WantedValues& wanted) {
  GrowingBox box;
  add_bricks(volume, wanted, box);
  add_constants(volume, wanted, box);
  return box.box();
}

}  // namespace tet
