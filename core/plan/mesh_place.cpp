#include "core/plan/mesh_place.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <absl/status/status.h>
#include <absl/strings/str_format.h>

#include "core/scene/scene.h"
#include "core/volume/inside.h"
#include "core/volume/to_voxel.h"

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

VoxelCoord middle_of(const VoxelBox& box) {
  const auto middle = [](std::int32_t a, std::int32_t b) {
    return static_cast<std::int32_t>((std::int64_t{a} + b) >> 1);
  };
  return {middle(box.min.x, box.max.x), middle(box.min.y, box.max.y),
          middle(box.min.z, box.max.z)};
}

/// The lattice corner next to a point.
absl::StatusOr<VoxelCoord> corner_next_to(const WorldPoint& point,
                                          const VoxelTransform& lattice) {
  const VoxelPoint at = to_voxel(lattice, point);
  const double reach = std::max({std::abs(at.x), std::abs(at.y), std::abs(at.z)});
  if (!(reach <= kMaxVoxelCoord)) {  // not-a-numbers end here too
    return absl::InvalidArgumentError(
        absl::StrFormat("origin (%g, %g, %g) is %g spacings from the lattice's own; the limit "
                        "is %d",
                        point.x, point.y, point.z, reach, kMaxVoxelCoord));
  }
  const auto rounded = [](double v) { return static_cast<std::int32_t>(std::lround(v)); };
  return VoxelCoord{rounded(at.x), rounded(at.y), rounded(at.z)};
}

/// How far a box reaches from a corner along any axis.
double reach_from(VoxelCoord corner, const VoxelBox& box) {
  const auto farther = [](std::int32_t from, std::int32_t min, std::int32_t max) {
    return std::max(std::abs(static_cast<double>(max) - from),
                    std::abs(static_cast<double>(min) - from));
  };
  return std::max({farther(corner.x, box.min.x, box.max.x),
                   farther(corner.y, box.min.y, box.max.y),
                   farther(corner.z, box.min.z, box.max.z)});
}

}  // namespace

VoxelBox corner_box(const BrickBox& domain) {
  const auto corner = [](BrickCoord b) { return VoxelCoord{8 * b.x, 8 * b.y, 8 * b.z}; };
  const BrickCoord last = domain.max;
  return {corner(domain.min), corner({last.x + 1, last.y + 1, last.z + 1})};
}

WorldBox world_box_of(const BrickBox& domain, const VoxelTransform& lattice) {
  const VoxelBox corners = corner_box(domain);
  return lattice.to_world_box(point_of(corners.min), point_of(corners.max));
}

WorldBox world_box_of(const BrickBox& domain, const PhiField& field) {
  return world_box_of(domain, field.lattice_transform());
}

bool is_far(const WorldBox& bounds, const WorldPoint& origin, double spacing) noexcept {
  const auto reach = [&](const WorldPoint& p) {
    return std::max(
        {std::abs(p.x - origin.x), std::abs(p.y - origin.y), std::abs(p.z - origin.z)});
  };
  return std::max(reach(bounds.min), reach(bounds.max)) > kMaxFloat32Extent * spacing;
}

std::string inside_guess_of(const PhiField& field, const MeshRequest& request) {
  return field.volume == nullptr ? field.scene->inside_guess
                                 : describe_guess(*field.volume, request.inside, field.iso);
}

absl::StatusOr<LatticeToWorld> place_in_world(const PhiField& field,
                                              const VoxelBox& corners,
                                              double beyond,
                                              const MeshRequest& request,
                                              MeshHeader& header) {
  header.inside_guess = inside_guess_of(field, request);
  return place_lattice(field.lattice_transform(), corners, beyond, request, header);
}

absl::StatusOr<LatticeToWorld> place_lattice(const VoxelTransform& lattice,
                                             const VoxelBox& corners,
                                             double beyond,
                                             const MeshRequest& request,
                                             MeshHeader& header) {
  const absl::StatusOr<VoxelCoord> origin =
      request.origin ? corner_next_to(*request.origin, lattice) : middle_of(corners);
  if (!origin.ok()) return origin.status();
  header.origin = lattice.to_world(point_of(*origin));
  header.bounds = lattice.to_world_box(shifted(point_of(corners.min), -beyond),
                                       shifted(point_of(corners.max), beyond));
  header.spacing = lattice.voxel_size;
  const bool far = reach_from(*origin, corners) > kMaxFloat32Extent;
  header.coordinate_type =
      request.coordinates.value_or(far ? CoordinateType::kFloat64 : CoordinateType::kFloat32);
  return LatticeToWorld{lattice.linear, *origin, lattice.mirrors()};
}

}  // namespace tet
