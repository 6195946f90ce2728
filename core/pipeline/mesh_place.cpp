#include "core/pipeline/mesh_place.h"

#include <algorithm>
#include <cstdint>

namespace tet {
namespace {

/// A float32 coordinate is off by at most 2^-24 of its size, so within this many spacings of
/// the origin by 2^-12 of a spacing: what that does to angles is in angle_bounds.
constexpr double kMaxFloat32Extent = 4096;

VoxelPoint point_of(VoxelCoord v) {
  return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}

VoxelPoint shifted(VoxelPoint p, double along_every_axis) {
  return {p.x + along_every_axis, p.y + along_every_axis, p.z + along_every_axis};
}

}  // namespace

LatticeToWorld place_in_world(const PhiField& field,
                              const VoxelBox& corners,
                              double beyond,
                              const std::optional<CoordinateType>& coordinates,
                              MeshHeader& header) {
  const VoxelTransform lattice = field.lattice_transform();
  const auto& [min, max] = corners;
  const auto middle = [](std::int32_t a, std::int32_t b) {
    return static_cast<std::int32_t>((std::int64_t{a} + b) >> 1);
  };
  const VoxelCoord centre{middle(min.x, max.x), middle(min.y, max.y), middle(min.z, max.z)};
  const double extent =
      std::max({static_cast<double>(max.x) - centre.x, static_cast<double>(max.y) - centre.y,
                static_cast<double>(max.z) - centre.z});
  header.origin = lattice.to_world(point_of(centre));
  header.bounds =
      lattice.to_world_box(shifted(point_of(min), -beyond), shifted(point_of(max), beyond));
  header.spacing = lattice.voxel_size;
  header.coordinate_type = coordinates.value_or(
      extent > kMaxFloat32Extent ? CoordinateType::kFloat64 : CoordinateType::kFloat32);
  return {lattice.linear, centre, lattice.mirrors()};
}

}  // namespace tet
