// World points in index space.
#pragma once

#include "core/base/types.h"
#include "core/volume/volume.h"

namespace tet {

/// Axis-aligned box in index space.
struct VoxelSpan {
  VoxelPoint min, max;
};

/// The inverse of VoxelTransform::to_world.
VoxelPoint to_voxel(const VoxelTransform& transform, const WorldPoint& p) noexcept;

/// Box of voxels around a world box.
VoxelSpan to_voxel_span(const VoxelTransform& transform, const WorldBox& box) noexcept;

}  // namespace tet
