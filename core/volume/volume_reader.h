// Reading a volume at any voxel: region, then brick, then value.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/types.h"
#include "core/volume/volume.h"

namespace tet {

/// Looks values up; remembers the region it was in last, so neighbouring reads are quick.
///
/// Not thread-safe: one per task. The volume must outlive it.
class VolumeReader {
 public:
  explicit VolumeReader(const Volume& volume) : volume_(&volume) {}

  struct Brick {
    const float* values = nullptr;  ///< 512 values, or null where the brick is constant
    ValueRange range;               ///< of the values, or twice the constant
  };
  Brick brick(BrickCoord coord) noexcept;

  float value(VoxelCoord voxel) noexcept;

  /// The values at the eight voxels of the cell at `min`, at 4*x + 2*y + z.
  using Cell = std::array<float, 8>;
  Cell cell(VoxelCoord min) noexcept;

  /// Trilinear interpolation between the eight voxel centres around `p`.
  double trilinear(const VoxelPoint& p) noexcept;

  /// The 128-voxel region at `region_min` (a multiple of 16 bricks).
  struct RegionOrConstant {
    const Region* region;  ///< null: `constant` throughout
    float constant;
  };
  RegionOrConstant region(BrickCoord region_min) noexcept;

 private:
  /// Makes the region at `region_min` the one that is read.
  void enter(BrickCoord region_min) noexcept {
    if (!entered_ || region_min != region_min_) find_region(region_min);
  }
  void find_region(BrickCoord region_min) noexcept;

  const Volume* volume_;
  bool entered_ = false;
  BrickCoord region_min_;
  const Region* region_ = nullptr;  // null: `constant_` throughout
  float constant_ = 0;
};

// Left to choose, the compiler inlines these two or not depending on what else it compiles at
// once; calling them costs half of the search for cut points.

[[gnu::always_inline]] inline VolumeReader::Brick VolumeReader::brick(
    BrickCoord coord) noexcept {
  constexpr std::int32_t kLast = Region::kEdgeBricks - 1;
  enter({coord.x & ~kLast, coord.y & ~kLast, coord.z & ~kLast});
  if (region_ == nullptr) {
    return {nullptr, {constant_, constant_}};
  }
  const auto at = static_cast<std::size_t>(
      ((coord.x & kLast) * Region::kEdgeBricks + (coord.y & kLast)) * Region::kEdgeBricks +
      (coord.z & kLast));
  const std::uint32_t index = region_->brick_index[at];
  if (index == Region::kConstant) {
    return {nullptr, {region_->constant[at], region_->constant[at]}};
  }
  return {volume_->values.data() + std::size_t{index} * kBrickCells, volume_->ranges[index]};
}

[[gnu::always_inline]] inline float VolumeReader::value(VoxelCoord voxel) noexcept {
  const Brick found =
      brick({voxel.x >> kBrickShift, voxel.y >> kBrickShift, voxel.z >> kBrickShift});
  if (found.values == nullptr) return found.range.min;
  return found.values[((voxel.x & 7) * 8 + (voxel.y & 7)) * 8 + (voxel.z & 7)];
}

}  // namespace tet
