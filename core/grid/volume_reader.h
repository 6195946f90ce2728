// Reading a volume at any voxel: region, then brick, then value.
#pragma once

#include "core/base/types.h"
#include "core/grid/volume.h"

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

  /// Trilinear interpolation between the eight voxel centres around `p`.
  double trilinear(const VoxelPoint& p) noexcept;

  /// The 128-voxel region at `region_min` (a multiple of 16 bricks).
  struct RegionOrConstant {
    const Region* region;  ///< null: `constant` throughout
    float constant;
  };
  RegionOrConstant region(BrickCoord region_min) noexcept;

 private:
  void enter(BrickCoord region_min) noexcept;

  const Volume* volume_;
  bool entered_ = false;
  BrickCoord region_min_;
  const Region* region_ = nullptr;  // null: `constant_` throughout
  float constant_ = 0;
};

}  // namespace tet
