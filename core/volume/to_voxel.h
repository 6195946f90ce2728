// World points in index space.
#pragma once

#include <array>

#include "core/base/types.h"
#include "core/volume/volume.h"

namespace tet {

/// Axis-aligned box in index space.
struct VoxelSpan {
  VoxelPoint min, max;
};

/// The inverse of a map's `linear`, for voxels of any shape: voxel = row * (world -
/// translation) / divisor.
///
/// The inverse of a scaled rotation is its transpose over the square of the scale. Voxels that
/// are cubes up to what float32 matrices are off by count as cubic, and have none of their own:
/// by the transpose they would be off by that part of an index, half a voxel at voxel 10,000.
struct InverseLinear {
  std::array<std::array<double, 3>, 3> row{};
  double divisor = 1;  ///< 1 unless `row` is the transpose

  explicit InverseLinear(const VoxelTransform& transform) noexcept;

  /// Takes the divisor into the rows.
  std::array<std::array<double, 3>, 3> matrix() const noexcept;
};

/// The inverse of VoxelTransform::to_world, for many points.
class ToVoxel {
 public:
  explicit ToVoxel(const VoxelTransform& transform) noexcept
      : inverse_(transform), translation_(transform.translation) {}

  VoxelPoint operator()(const WorldPoint& p) const noexcept;
  const InverseLinear& inverse() const noexcept { return inverse_; }

 private:
  InverseLinear inverse_;
  std::array<double, 3> translation_;
};

/// The inverse of VoxelTransform::to_world.
inline VoxelPoint to_voxel(const VoxelTransform& transform, const WorldPoint& p) noexcept {
  return ToVoxel(transform)(p);
}

/// Box of voxels around a world box.
VoxelSpan to_voxel_span(const VoxelTransform& transform, const WorldBox& box) noexcept;

}  // namespace tet
