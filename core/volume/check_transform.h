// Which maps from voxels to the world can be meshed.
#pragma once

#include <absl/status/status.h>

#include "core/volume/volume.h"

namespace tet {

/// The edge of a voxel if all three were equal, from `linear` alone; not finite for a map
/// beyond double's range.
double voxel_edge(const VoxelTransform& transform) noexcept;

/// Ok when the map is finite, its voxels are cubes up to what float32 matrices are off by, and
/// `voxel_size` is their edge. Errors: kFailedPrecondition (says what to do).
absl::Status check_transform(const VoxelTransform& transform);

}  // namespace tet
