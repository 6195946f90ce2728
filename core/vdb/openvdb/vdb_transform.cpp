#include "core/vdb/openvdb/vdb_transform.h"

#include <cstddef>
#include <memory>

#include <absl/status/status.h>
#include <openvdb/math/Maps.h>

#include "core/vdb/openvdb/stored_map.h"
#include "core/volume/check_transform.h"

namespace tet {
namespace {

using openvdb::Vec3d;

bool is_frustum(const openvdb::math::MapBase& map) {
  return map.type() == openvdb::math::NonlinearFrustumMap::mapType();
}

}  // namespace

absl::StatusOr<VoxelTransform> voxel_transform(const openvdb::math::Transform& transform) {
  const openvdb::math::MapBase& map = *transform.baseMap();
  if (is_frustum(map)) {
    return absl::FailedPreconditionError(
        "its transform is a frustum, whose voxels differ in size: resample the grid onto a "
        "linear transform");
  }
  // Asked what it does to points: a map of small voxels has no matrix, as OpenVDB would invert
  // it.
  VoxelTransform result;
  const Vec3d translation = map.applyMap(Vec3d(0));
  for (int j = 0; j < 3; ++j) {
    Vec3d axis(0);
    axis[j] = 1;
    const Vec3d column = map.applyJacobian(axis);
    for (int i = 0; i < 3; ++i) {
      result.linear[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] = column[i];
    }
    result.translation[static_cast<std::size_t>(j)] = translation[j];
  }
  result.voxel_size = voxel_edge(result);
  if (absl::Status s = check_transform(result); !s.ok()) return s;
  return result;
}

openvdb::math::Transform::Ptr uniform_transform(double voxel_size,
                                                const WorldPoint& translation) {
  constexpr double kSmallestOwn = 1e-4;  // whose cube is well above what OpenVDB refuses
  const bool moved = translation != WorldPoint{};
  if (!moved && voxel_size >= kSmallestOwn) {
    return openvdb::math::Transform::createLinearTransform(voxel_size);
  }
  return std::make_shared<openvdb::math::Transform>(std::make_shared<StoredMap>(
      voxel_size, Vec3d(translation.x, translation.y, translation.z)));
}

}  // namespace tet
