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

/// The inverse of `linear` for voxels of any shape: voxel = this * (world - translation).
std::array<std::array<double, 3>, 3> inverse_linear(const VoxelTransform& transform) noexcept;

/// The inverse of VoxelTransform::to_world.
VoxelPoint to_voxel(const VoxelTransform& transform, const WorldPoint& p) noexcept;

/// Box of voxels around a world box.
VoxelSpan to_voxel_span(const VoxelTransform& transform, const WorldBox& box) noexcept;

}  // namespace tet
