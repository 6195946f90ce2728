#include "core/octree/region_shape.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/base/vec3.h"

namespace tet {
namespace {

Triple triple_of(const VoxelPoint& p) { return {p.x, p.y, p.z}; }
Triple triple_of(const WorldPoint& p) { return {p.x, p.y, p.z}; }

double distance_from_segment(const Triple& point, const Triple& start, const Triple& along) {
  const Triple from = difference(point, start);
  const double squared = dot(along, along);
  const double t = squared > 0 ? std::clamp(dot(from, along) / squared, 0.0, 1.0) : 0;
  const Triple off = difference(from, {t * along[0], t * along[1], t * along[2]});
  return std::sqrt(dot(off, off));
}

}  // namespace

RegionShape::RegionShape(const SizingRegion& region, const VoxelTransform& lattice) {
  std::visit([&](const auto& shape) { set(shape, lattice); }, region.shape);
}

void RegionShape::set(const WorldBox& box, const VoxelTransform& lattice) {
  shape_ = Box{box, lattice};
  bounds_ = to_voxel_span(lattice, box);
}

void RegionShape::set(const BallRegion& ball, const VoxelTransform& lattice) {
  set(CapsuleRegion{ball.centre, ball.centre, ball.radius}, lattice);
}

void RegionShape::set(const CapsuleRegion& capsule, const VoxelTransform& lattice) {
  const VoxelPoint start = to_voxel(lattice, capsule.start),
                   end = to_voxel(lattice, capsule.end);
  const double radius = capsule.radius / lattice.voxel_size;
  shape_ = Capsule{triple_of(start), difference(triple_of(end), triple_of(start)), radius};
  bounds_ = {{std::min(start.x, end.x) - radius, std::min(start.y, end.y) - radius,
              std::min(start.z, end.z) - radius},
             {std::max(start.x, end.x) + radius, std::max(start.y, end.y) + radius,
              std::max(start.z, end.z) + radius}};
}

Reach RegionShape::reach(const LatticeSpan& span) const noexcept {
  return std::visit([&](const auto& shape) { return reach(shape, span); }, shape_);
}

/// Compares the world's box around the span, which is the span itself where the lattice is not
/// turned.
Reach RegionShape::reach(const Box& box, const LatticeSpan& span) noexcept {
  const auto& [x, y, z] = span.centre;
  const Triple centre = triple_of(box.lattice.to_world({x, y, z}));
  const Triple min = triple_of(box.box.min), max = triple_of(box.box.max);
  bool all = true;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    // Faces that are meant to meet do so within rounding errors; a thinner box, between two
    // cells, is still in both.
    const double same = std::min(1e-6 * box.lattice.voxel_size, (max[axis] - min[axis]) / 4);
    double half = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      half += std::abs(box.lattice.linear[axis][i]) * span.half[i];
    }
    const double low = centre[axis] - half, high = centre[axis] + half;
    if (high <= min[axis] + same || low >= max[axis] - same) return Reach::kNone;
    all = all && low >= min[axis] - same && high <= max[axis] + same;
  }
  return all ? Reach::kAll : Reach::kPart;
}

/// Compares the ball around the span.
Reach RegionShape::reach(const Capsule& capsule, const LatticeSpan& span) noexcept {
  const double away = distance_from_segment(span.centre, capsule.start, capsule.along);
  const double around = std::sqrt(dot(span.half, span.half));
  if (away > capsule.radius + around) return Reach::kNone;
  return away <= capsule.radius - around ? Reach::kAll : Reach::kPart;
}

}  // namespace tet
