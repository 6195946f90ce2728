#include "core/field/world_phi.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/scene/scene_evaluator.h"
#include "core/volume/trilinear_cell.h"

namespace tet {
namespace {

/// A cell of eight voxels, and where a point lies in it. Far outside, where nothing is stored,
/// all cells are alike.
struct AxisPlace {
  explicit AxisPlace(double voxel) noexcept {
    constexpr double kMost = kMaxVoxelCoord;
    // A coordinate that is not a number ends at the low end, too.
    const double within = voxel > -kMost ? std::min(voxel, kMost) : -kMost;
    const double low = std::floor(within);
    cell = static_cast<std::int32_t>(low);
    rest = within - low;
  }
  std::int32_t cell;
  double rest;
};

}  // namespace

WorldPhi::WorldPhi(const PhiField& field, double step) : field_(field), step_(step) {
  if (field.scene == nullptr) {
    reader_.emplace(*field.volume);
    to_voxel_.emplace(field.volume->transform);
  } else {
    scene_ = std::make_unique<SceneEvaluator>(*field.scene);
  }
}

WorldPhi::~WorldPhi() = default;
WorldPhi::WorldPhi(WorldPhi&&) noexcept = default;
WorldPhi& WorldPhi::operator=(WorldPhi&&) noexcept = default;

double WorldPhi::at(const WorldPoint& p) noexcept {
  return scene_ != nullptr ? scene_->at(p) : slope_in_volume(p).phi;
}

PhiSlope WorldPhi::slope_at(const WorldPoint& p) noexcept {
  return scene_ != nullptr ? slope_in_scene(p) : slope_in_volume(p);
}

PhiSlope WorldPhi::slope_in_scene(const WorldPoint& p) noexcept {
  scene::Points points;
  for (std::size_t i = 0; i < 7; ++i) {
    const auto moved = [&](std::size_t axis) {
      return i == 2 * axis + 1 ? step_ : i == 2 * axis + 2 ? -step_ : 0;
    };
    points.x[i] = p.x + moved(0);
    points.y[i] = p.y + moved(1);
    points.z[i] = p.z + moved(2);
  }
  const double* const phi = scene_->evaluate(points, 7);
  const auto slope = [&](std::size_t i) { return (phi[i] - phi[i + 1]) / (2 * step_); };
  return {phi[0], {slope(1), slope(3), slope(5)}};
}

PhiSlope WorldPhi::slope_in_volume(const WorldPoint& p) noexcept {
  const VoxelPoint voxel = (*to_voxel_)(p);
  const AxisPlace x(voxel.x), y(voxel.y), z(voxel.z);
  TrilinearCell values{};
  std::ranges::copy(reader_->cell({x.cell, y.cell, z.cell}), values.corner.begin());
  const ValueSlope found = values.at(x.rest, y.rest, z.rest);
  const double sign = field_.negated() ? -1 : 1;
  // A slope goes the other way than points do, so its map is the inverse, transposed.
  const InverseLinear& inverse = to_voxel_->inverse();
  const double scale = sign / inverse.divisor;
  const auto across = [&](std::size_t axis) {
    return scale *
           (inverse.row[0][axis] * found.slope.x + inverse.row[1][axis] * found.slope.y +
            inverse.row[2][axis] * found.slope.z);
  };
  return {sign * (found.value - static_cast<double>(field_.iso)),
          {across(0), across(1), across(2)}};
}

}  // namespace tet
