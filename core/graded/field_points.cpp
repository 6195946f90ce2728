#include "core/graded/field_points.h"

#include <algorithm>

namespace tet {

void NodeBounds::add(LatticeCoord node) noexcept {
  const std::array<double, 3> at{0.5 * node.x, 0.5 * node.y, 0.5 * node.z};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    min_[axis] = empty_ ? at[axis] : std::min(min_[axis], at[axis]);
    max_[axis] = empty_ ? at[axis] : std::max(max_[axis], at[axis]);
  }
  empty_ = false;
}

WorldPoint NodeBounds::middle() const noexcept {
  return {(min_[0] + max_[0]) / 2, (min_[1] + max_[1]) / 2, (min_[2] + max_[2]) / 2};
}

double NodeBounds::half_edge() const noexcept {
  return std::max({max_[0] - min_[0], max_[1] - min_[1], max_[2] - min_[2]}) / 2;
}

void LatticeSampler::focus(const NodeBounds& bounds) noexcept {
  if (sampler_.field().scene == nullptr) return;
  constexpr double kRounding = 1 + 1e-9;
  const double spacing = sampler_.field().spacing_voxels;
  const auto [x, y, z] = bounds.middle();
  sampler_.scene().focus({spacing * x, spacing * y, spacing * z},
                         kRounding * spacing * bounds.half_edge());
}

void LatticeSampler::sample(const FieldPoints& points,
                            std::size_t count,
                            double* phi) noexcept {
  if (sampler_.field().scene == nullptr) {
    for (std::size_t i = 0; i < count; ++i) {
      phi[i] = static_cast<double>(sampler_.at(points.x[i], points.y[i], points.z[i]));
    }
    return;
  }
  static_assert(FieldPoints::kSize <= scene::kMaxPoints);
  const double spacing = sampler_.field().spacing_voxels;
  scene::Points world{};
  for (std::size_t i = 0; i < count; ++i) {
    world.x[i] = spacing * points.x[i];
    world.y[i] = spacing * points.y[i];
    world.z[i] = spacing * points.z[i];
  }
  std::copy_n(sampler_.scene().evaluate(world, count), count, phi);
}

}  // namespace tet
