#include "core/vdb/vdb_transform.h"

#include <cstddef>

#include <absl/status/status.h>

#include "core/volume/check_transform.h"

namespace tet {

absl::StatusOr<VoxelTransform> voxel_transform(const openvdb::math::Transform& transform) {
  if (!transform.isLinear()) {
    return absl::FailedPreconditionError(
        "its transform is a frustum, whose voxels differ in size: resample the grid onto a "
        "linear transform");
  }
  // OpenVDB multiplies row vectors from the left.
  const openvdb::Mat4d rows = transform.baseMap()->getAffineMap()->getMat4();
  VoxelTransform result;
  for (int i = 0; i < 3; ++i) {
    const auto row = static_cast<std::size_t>(i);
    for (int j = 0; j < 3; ++j) result.linear[row][static_cast<std::size_t>(j)] = rows(j, i);
    result.translation[row] = rows(3, i);
  }
  result.voxel_size = voxel_edge(result);
  if (absl::Status s = check_transform(result); !s.ok()) return s;
  return result;
}

}  // namespace tet
