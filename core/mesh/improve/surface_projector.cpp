#include "core/mesh/improve/surface_projector.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/scene/scene_evaluator.h"
#include "core/volume/trilinear_cell.h"

namespace tet {

SurfaceProjector::SurfaceProjector(const PhiField& field,
                                   const LatticeToWorld& to_world,
                                   const MeshHeader& mesh)
    : field_(field),
      to_voxels_(field.voxel_transform()),
      per_divisor_(1 / to_voxels_.divisor),
      spacing_(mesh.spacing),
      floats_(mesh.coordinate_type == CoordinateType::kFloat32) {
  if (field.scene != nullptr) {
    scene_ = std::make_unique<SceneEvaluator>(*field.scene);
  } else {
    reader_.emplace(*field.volume);
  }
  // A scene's voxels are world units, and a far origin lies beyond the numbers of voxels.
  const auto split = [&](std::int32_t lattice, double& whole, double& rest) {
    const double voxel = field.spacing_voxels * lattice;
    whole = std::floor(voxel);
    rest = voxel - whole;
  };
  split(to_world.origin.x, origin_.x, beyond_origin_.x);
  split(to_world.origin.y, origin_.y, beyond_origin_.y);
  split(to_world.origin.z, origin_.z, beyond_origin_.z);
}

SurfaceProjector::~SurfaceProjector() = default;
SurfaceProjector::SurfaceProjector(SurfaceProjector&&) noexcept = default;
SurfaceProjector& SurfaceProjector::operator=(SurfaceProjector&&) noexcept = default;

/// The slope from differences over a small part of the spacing.
PhiSlope SurfaceProjector::at_world(const WorldPoint& p) noexcept {
  const double step = kTolerance * spacing_;
  scene::Points points;
  for (std::size_t i = 0; i < 7; ++i) {
    const auto moved = [&](std::size_t axis) {
      return i == 2 * axis + 1 ? step : i == 2 * axis + 2 ? -step : 0;
    };
    points.x[i] = p.x + moved(0);
    points.y[i] = p.y + moved(1);
    points.z[i] = p.z + moved(2);
  }
  const double* phi = scene_->evaluate(points, 7);
  const auto slope = [&](std::size_t i) { return (phi[i] - phi[i + 1]) / (2 * step); };
  return {phi[0], {slope(1), slope(3), slope(5)}};
}

PhiSlope SurfaceProjector::at(const WorldPoint& p) noexcept {
  const auto along = [&](std::size_t axis) {
    const auto& row = to_voxels_.row[axis];
    return per_divisor_ * (row[0] * p.x + row[1] * p.y + row[2] * p.z);
  };
  const double x = beyond_origin_.x + along(0);
  const double y = beyond_origin_.y + along(1);
  const double z = beyond_origin_.z + along(2);
  return scene_ != nullptr ? at_world({origin_.x + x, origin_.y + y, origin_.z + z})
                           : at_voxel(x, y, z);
}

/// At a voxel relative to the origin.
PhiSlope SurfaceProjector::at_voxel(double x, double y, double z) noexcept {
  const double cx = std::floor(x), cy = std::floor(y), cz = std::floor(z);
  // Beyond index space nothing is stored, and all cells are alike.
  const auto index = [](double voxel) {
    constexpr double kMost = 2.0 * kMaxVoxelCoord;
    return static_cast<std::int32_t>(std::clamp(voxel, -kMost, kMost));
  };
  const VoxelCoord cell{index(origin_.x + cx), index(origin_.y + cy), index(origin_.z + cz)};
  TrilinearCell values{};
  for (int i = 0; i < 8; ++i) {
    values.corner[static_cast<std::size_t>(i)] =
        reader_->value({cell.x + (i >> 2), cell.y + (i >> 1 & 1), cell.z + (i & 1)});
  }
  const ValueSlope voxel = values.at(x - cx, y - cy, z - cz);
  const double sign = field_.negated() ? -1 : 1;
  const Vector& g = voxel.slope;
  // A slope goes the other way than points do, so its map is the inverse, transposed.
  const auto across = [&](std::size_t axis) {
    const auto& row = to_voxels_.row;
    return sign * per_divisor_ * (row[0][axis] * g.x + row[1][axis] * g.y + row[2][axis] * g.z);
  };
  return {sign * (voxel.value - static_cast<double>(field_.iso)),
          {across(0), across(1), across(2)}};
}

bool SurfaceProjector::is_on_surface(const PhiSlope& here) const noexcept {
  const double reach = kOnSurface * spacing_;
  return here.phi * here.phi <= reach * reach * dot(here.gradient, here.gradient);
}

std::optional<WorldPoint> SurfaceProjector::project(const WorldPoint& p,
                                                    const Vector& slope) noexcept {
  constexpr int kSteps = 6;
  const double steepness = std::sqrt(dot(slope, slope));
  const double close = kTolerance * spacing_ * steepness;
  const double farthest = kReach * spacing_;
  double before = 0, phi_before = at(p).phi;
  double t = -phi_before / steepness;
  for (int step = 0; step < kSteps && std::abs(t) <= farthest; ++step) {
    const double scale = t / steepness;
    const WorldPoint place =
        rounded({p.x + scale * slope.x, p.y + scale * slope.y, p.z + scale * slope.z});
    const double phi = at(place).phi;
    if (std::abs(phi) <= close) return place;
    const double secant = t - phi * (t - before) / (phi - phi_before);
    before = t;
    phi_before = phi;
    t = secant;  // not a number ends the loop
  }
  return std::nullopt;
}

WorldPoint SurfaceProjector::rounded(const WorldPoint& p) const noexcept {
  if (!floats_) return p;
  const auto round = [](double v) { return static_cast<double>(static_cast<float>(v)); };
  return {round(p.x), round(p.y), round(p.z)};
}

}  // namespace tet
