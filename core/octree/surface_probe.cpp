#include "core/octree/surface_probe.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "core/field/domain.h"

namespace tet {
namespace {

constexpr double kStep = 1.5;  // of a voxel or a spacing: within half a narrow band of three

using Axes = std::array<VoxelPoint, 3>;

VoxelPoint along(const VoxelPoint& p, const VoxelPoint& direction, double length) noexcept {
  return {p.x + length * direction.x, p.y + length * direction.y, p.z + length * direction.z};
}

constexpr Axes kAxes{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

}  // namespace

std::optional<StoredExtent> stored_extent_amid_inside(const PhiField& field) {
  if (field.volume == nullptr || !(field.phi(field.volume->background) < 0)) return {};
  const VoxelBox box = stored_box(*field.volume);
  if (box.empty()) return {};
  // Between the outermost voxels and the background there are values of both.
  constexpr double kAround = 2;
  const std::array<double, 3> low{box.min.x - kAround, box.min.y - kAround,
                                  box.min.z - kAround},
      high{box.max.x + kAround, box.max.y + kAround, box.max.z + kAround};
  const double spacing = field.spacing_voxels;
  if (field.scene == nullptr) {
    return StoredExtent{{low[0] / spacing, low[1] / spacing, low[2] / spacing},
                        {high[0] / spacing, high[1] / spacing, high[2] / spacing}};
  }
  const auto [min, max] = field.volume->transform.to_world_box({low[0], low[1], low[2]},
                                                               {high[0], high[1], high[2]});
  return StoredExtent{{min.x / spacing, min.y / spacing, min.z / spacing},
                      {max.x / spacing, max.y / spacing, max.z / spacing}};
}

SurfaceProbe::SurfaceProbe(const PhiField& field, const std::optional<StoredExtent>& extent)
    : sampler_(field),
      extent_(extent),
      step_(kStep * (field.scene == nullptr ? std::max(1.0, 1 / field.spacing_voxels) : 1.0)) {}

void SurfaceProbe::stop_when(const Cancellation& cancellation) noexcept {
  cancellation_ = &cancellation;
  sampler_.stop_when(cancellation);
}

VoxelPoint SurfaceProbe::gradient(const VoxelPoint& p) noexcept {
  std::array<double, 3> slope{};
  for (std::size_t i = 0; i < 3; ++i) {
    slope[i] = (at(along(p, kAxes[i], step_)) - at(along(p, kAxes[i], -step_))) / (2 * step_);
  }
  return {slope[0], slope[1], slope[2]};
}

void SurfaceProbe::visit(const VoxelPoint& p) noexcept {
  const auto turn_to = [&](const VoxelPoint& place) {
    const VoxelPoint slope = gradient(place);
    slope_ = std::sqrt(slope.x * slope.x + slope.y * slope.y + slope.z * slope.z);
    normal_ = slope_ > 0 ? along({}, slope, 1 / slope_) : VoxelPoint{};
  };
  turn_to(p);
  at_surface_ = p;
  if (slope_ == 0) return;
  const double distance = std::clamp(at(p) / slope_, -2 * step_, 2 * step_);
  at_surface_ = along(p, normal_, -distance);
  turn_to(at_surface_);
  measure_hessian();
}

void SurfaceProbe::measure_hessian() noexcept {
  const double middle = at(at_surface_), area = step_ * step_;
  for (std::size_t i = 0; i < 3; ++i) {
    const VoxelPoint up = along(at_surface_, kAxes[i], step_);
    const VoxelPoint down = along(at_surface_, kAxes[i], -step_);
    hessian_[i][i] = (at(up) - 2 * middle + at(down)) / area;
    for (std::size_t j = 0; j < i; ++j) {
      const double mixed = at(along(up, kAxes[j], step_)) - at(along(up, kAxes[j], -step_)) -
                           at(along(down, kAxes[j], step_)) + at(along(down, kAxes[j], -step_));
      hessian_[i][j] = hessian_[j][i] = mixed / (4 * area);
    }
  }
}

/// The surface's shape operator is the Hessian within the tangent plane, over the slope: its
/// trace and the sum of its squares give both curvatures.
double SurfaceProbe::curvature() const noexcept {
  if (slope_ == 0) return 0;
  const std::array<double, 3> n{normal_.x, normal_.y, normal_.z};
  double trace = 0, squares = 0, across = 0, of_normal = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    double row = 0;
    for (std::size_t j = 0; j < 3; ++j) {
      row += hessian_[i][j] * n[j];
      squares += hessian_[i][j] * hessian_[i][j];
    }
    trace += hessian_[i][i];
    across += row * row;
    of_normal += n[i] * row;
  }
  const double sum = (trace - of_normal) / slope_;
  const double sum_of_squares =
      (squares - 2 * across + of_normal * of_normal) / (slope_ * slope_);
  const double difference = std::sqrt(std::max(0.0, 2 * sum_of_squares - sum * sum));
  return (std::abs(sum) + difference) / 2;
}

/// How far behind the surface one has left the extent for good.
double SurfaceProbe::depth_of_extent() const noexcept {
  double depth = std::numeric_limits<double>::infinity();
  if (!extent_) return depth;
  const std::array<double, 3> from{at_surface_.x, at_surface_.y, at_surface_.z},
      outward{normal_.x, normal_.y, normal_.z};
  for (std::size_t i = 0; i < 3; ++i) {
    if (outward[i] == 0) continue;
    const double end = outward[i] > 0 ? extent_->min[i] : extent_->max[i];
    depth = std::min(depth, (from[i] - end) / outward[i]);
  }
  return depth;
}

double SurfaceProbe::thickness(double most) noexcept {
  if (slope_ == 0) return most;
  constexpr std::size_t kStepsPerLook = 1024;
  const double end = std::min(most, depth_of_extent());
  std::size_t steps = 0;
  // phi of a level set ends at the width of its band, and rises no faster than its slope.
  const double least = step_ / kStep / 2;
  double depth = least, before = 0, phi_before = 0;
  while (depth < end) {
    const bool looks = ++steps % kStepsPerLook == 0 && cancellation_ != nullptr;
    if (looks && cancellation_->requested()) return most;
    const double phi = at(along(at_surface_, normal_, -depth));
    if (phi >= 0) {
      const double part = phi_before < 0 ? phi_before / (phi_before - phi) : 1;
      return before + part * (depth - before);
    }
    before = depth;
    phi_before = phi;
    depth += std::max(least, -phi / slope_ / 2);
  }
  return most;
}

}  // namespace tet
