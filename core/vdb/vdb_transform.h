// OpenVDB's maps, as far as the mesher accepts them.
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

}  // namespace tet
