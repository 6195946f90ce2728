// A map as another program's float32 matrix may be.
#pragma once

#include "core/volume/check_transform.h"
#include "core/volume/volume.h"

namespace tet::test {

/// Turned about z, moved, and sheared by six hundred-thousandths: it counts as cubic, and its
/// inverse is another matrix than its transpose.
inline VoxelTransform nearly_cubic() {
  VoxelTransform transform;
  transform.linear = {{{0.4, -0.3, 0}, {0.3, 0.4, 4e-5}, {0, 0, 0.5}}};
  transform.translation = {3, -40, 11};
  transform.voxel_size = voxel_edge(transform);
  return transform;
}

/// A voxel at which the transpose would be off by half a voxel.
inline constexpr VoxelCoord kFarVoxel{-4000, 8000, 10000};

}  // namespace tet::test
