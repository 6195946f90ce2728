#include "core/vdb/openvdb/voxel_surface.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include <absl/strings/str_format.h>

#include "core/base/parallel.h"
#include "core/base/tet_geometry.h"
#include "core/volume/check_transform.h"

namespace tet {
namespace {

/// Conversion takes about 16 bytes for a voxel of the band.
constexpr double kMaxBandVoxels = 1e9;

/// Surfaces with all of their vertices so near to the world's origin have their voxels where
/// the origin's are; others have them around their own middle. OpenVDB and the mesher know
/// places of voxels to fractions of 32 bits.
constexpr double kNearVoxels = 8192;

double widest(const WorldBox& box) {
  return std::max({box.max.x - box.min.x, box.max.y - box.min.y, box.max.z - box.min.z});
}

double farthest(const WorldBox& box) {
  return std::max({-box.min.x, -box.min.y, -box.min.z, box.max.x, box.max.y, box.max.z});
}

WorldBox bounds(const TriangleSurface& surface) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  WorldBox box{{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}};
  for (const auto& triangle : surface.triangles) {
    for (const std::uint32_t id : triangle) {
      const WorldPoint& p = surface.vertices[id];
      box.min = {std::min(box.min.x, p.x), std::min(box.min.y, p.y), std::min(box.min.z, p.z)};
      box.max = {std::max(box.max.x, p.x), std::max(box.max.y, p.y), std::max(box.max.z, p.z)};
    }
  }
  return box;
}

/// About how many voxels lie within the band: around each triangle, and no more than the box
/// holds.
double estimate_band_voxels(const TriangleSurface& surface, const WorldBox& box) {
  constexpr double kBand = 2 * kHalfBand + 1;
  double around = 0;
  for (const auto& t : surface.triangles) {
    const Vector u = from_to(surface.vertices[t[0]], surface.vertices[t[1]]);
    const Vector v = from_to(surface.vertices[t[0]], surface.vertices[t[2]]);
    const Vector n = cross(u, v);
    const double area = std::sqrt(dot(n, n)) / 2;
    const double length = std::sqrt(std::max(dot(u, u), dot(v, v)));
    around += area * kBand + length * kBand * kBand;
  }
  const Vector e = from_to(box.min, box.max);
  return std::min(around, (e.x + kBand) * (e.y + kBand) * (e.z + kBand));
}

absl::Status too_many(double voxel_size, double voxels) {
  return absl::ResourceExhaustedError(absl::StrFormat(
      "with voxel size %g the band around the surface holds about %.3g voxels and the limit "
      "is %.3g: use larger voxels",
      voxel_size, voxels, kMaxBandVoxels));
}

absl::Status check_extent(const WorldBox& box, double voxel_size) {
  const double extent = widest(box);
  if (!std::isfinite(extent) || extent > 1e150 || farthest(box) > 1e150) {
    return absl::ResourceExhaustedError(absl::StrFormat(
        "the surface reaches %g from the origin and the limit is 1e150", farthest(box)));
  }
  // A triangle across so many voxels has a band of more than the limit.
  const double across = extent / voxel_size;
  return across > 1e8 ? too_many(voxel_size, across * across) : absl::OkStatus();
}

}  // namespace

absl::StatusOr<VoxelSurface> to_voxels(const TriangleSurface& surface, double voxel_size) {
  if (!(voxel_size > 0) || !std::isfinite(voxel_size)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("voxel size %g is not positive", voxel_size));
  }
  if (absl::Status s = check_edge("voxel size", voxel_size); !s.ok()) return s;
  if (surface.triangles.empty()) {
    return absl::InvalidArgumentError("the surface has no triangle");
  }
  const WorldBox box = bounds(surface);
  if (absl::Status s = check_extent(box, voxel_size); !s.ok()) return s;
  VoxelSurface result{surface, voxel_size, {}};
  if (farthest(box) > kNearVoxels * voxel_size) {
    result.translation = {box.min.x / 2 + box.max.x / 2, box.min.y / 2 + box.max.y / 2,
                          box.min.z / 2 + box.max.z / 2};
  }
  const WorldPoint& middle = result.translation;
  for_each_index(
      surface.vertices.size(),
      [&](std::size_t i) {
        const Vector p = from_to(middle, surface.vertices[i]);
        result.surface.vertices[i] = {p.x / voxel_size, p.y / voxel_size, p.z / voxel_size};
      },
      4096);
  const double voxels = estimate_band_voxels(result.surface, bounds(result.surface));
  if (voxels > kMaxBandVoxels) return too_many(voxel_size, voxels);
  return result;
}

}  // namespace tet
