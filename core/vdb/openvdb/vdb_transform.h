// OpenVDB's maps, as far as the mesher accepts them, and those that we make.
#pragma once

#include <absl/status/statusor.h>
#include <openvdb/math/Transform.h>

#include "core/volume/volume.h"

namespace tet {

/// The affine map from voxels to the world.
///
/// Errors: kFailedPrecondition (a frustum, sheared or stretched voxels, a scale that is not a
/// number or zero; says what to do).
absl::StatusOr<VoxelTransform> voxel_transform(const openvdb::math::Transform& transform);

/// world = voxel_size * voxel + translation, for voxels of any size: OpenVDB refuses to make
/// maps whose determinant is below 3e-15, though it writes, reads and applies them.
openvdb::math::Transform::Ptr uniform_transform(double voxel_size,
                                                const WorldPoint& translation);

}  // namespace tet
