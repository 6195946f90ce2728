#include "core/mesh/improve/interface_projector.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tet {
namespace {

double length(const Vector& v) noexcept { return std::sqrt(dot(v, v)); }

Vector times(double factor, const Vector& v) noexcept {
  return {factor * v.x, factor * v.y, factor * v.z};
}

Vector less(const Vector& a, const Vector& b) noexcept {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}

WorldPoint moved(const WorldPoint& p, const Vector& by) noexcept {
  return {p.x + by.x, p.y + by.y, p.z + by.z};
}

/// What is left of `v` across some directions of length 1.
Vector across(Vector v, std::span<const Vector> directions) noexcept {
  for (const Vector& direction : directions) v = less(v, times(dot(v, direction), direction));
  return v;
}

/// Functions whose slopes are nearer to one plane, or to one line, than this sine of an angle
/// do not tell where they vanish together.
constexpr double kLeastSine = 0.05;

}  // namespace

InterfaceProjector::InterfaceProjector(std::unique_ptr<InterfaceProbe> probe,
                                       const LatticeToWorld& to_world,
                                       const MeshHeader& mesh)
    : probe_(std::move(probe)),
      to_world_(to_world),
      to_lattice_(VoxelTransform{to_world.linear, {}, mesh.spacing}),
      per_divisor_(1 / to_lattice_.divisor),
      floats_(mesh.coordinate_type == CoordinateType::kFloat32) {}

WorldPoint InterfaceProjector::lattice_of(const WorldPoint& stored) const noexcept {
  const auto along = [&](std::size_t axis) {
    const auto& row = to_lattice_.row[axis];
    return per_divisor_ * (row[0] * stored.x + row[1] * stored.y + row[2] * stored.z);
  };
  return {to_world_.origin.x + along(0), to_world_.origin.y + along(1),
          to_world_.origin.z + along(2)};
}

WorldPoint InterfaceProjector::stored_of(const WorldPoint& lattice) const noexcept {
  const double x = lattice.x - to_world_.origin.x, y = lattice.y - to_world_.origin.y,
               z = lattice.z - to_world_.origin.z;
  const auto along = [&](std::size_t row) {
    const auto& linear = to_world_.linear[row];
    return linear[0] * x + linear[1] * y + linear[2] * z;
  };
  return rounded({along(0), along(1), along(2)});
}

WorldPoint InterfaceProjector::rounded(const WorldPoint& p) const noexcept {
  if (!floats_) return p;
  const auto round = [](double v) { return static_cast<double>(static_cast<float>(v)); };
  return {round(p.x), round(p.y), round(p.z)};
}

InterfaceProjector::Slopes InterfaceProjector::slopes_at(const WorldPoint& lattice) {
  Slopes slopes;
  probe_->at(lattice, std::span(slopes.of).first(functions_));
  return slopes;
}

bool InterfaceProjector::enter(std::span<const Label> labels, const WorldPoint& p) {
  functions_ = labels.size() - 1;
  const WorldPoint at = lattice_of(p);
  if (probe_ == nullptr || !probe_->choose(labels, at)) return false;
  const Slopes here = slopes_at(at);
  for (std::size_t i = 0; i < functions_; ++i) levels_[i] = here.of[i].value;
  return find_axes(here);
}

/// Axes of stored positions, from slopes in the lattice.
bool InterfaceProjector::find_axes(const Slopes& here) noexcept {
  for (std::size_t i = 0; i < functions_; ++i) {
    const Vector& slope = here.of[i].slope;
    // A slope goes the other way than points do, so its map is the inverse, transposed.
    const auto along_axis = [&](std::size_t axis) {
      const auto& row = to_lattice_.row;
      return row[0][axis] * slope.x + row[1][axis] * slope.y + row[2][axis] * slope.z;
    };
    const Vector across_it{along_axis(0), along_axis(1), along_axis(2)};
    const Vector rest = across(across_it, std::span(axes_).first(i));
    const double far = length(rest);
    if (!(far > kLeastSine * length(across_it))) return false;
    axes_[i] = times(1 / far, rest);
  }
  for (std::size_t i = functions_; i < 3; ++i) {
    // The coordinate axis that is farthest from those that there are.
    Vector best{};
    for (const Vector& axis : {Vector{1, 0, 0}, Vector{0, 1, 0}, Vector{0, 0, 1}}) {
      const Vector rest = across(axis, std::span(axes_).first(i));
      if (dot(rest, rest) > dot(best, best)) best = rest;
    }
    axes_[i] = times(1 / length(best), best);
  }
  return true;
}

Vector InterfaceProjector::along(const Vector& way) const noexcept {
  return across(way, std::span(axes_).first(functions_));
}

/// The shortest step, in the lattice, to where the functions would have `levels` if they were
/// what their slopes say. By orthogonal directions, one function after the other.
std::optional<Vector> InterfaceProjector::step_to(const Slopes& here,
                                                  const Levels& levels) const noexcept {
  std::array<Vector, kMostMeeting - 1> axis{};
  Vector step{};
  for (std::size_t i = 0; i < functions_; ++i) {
    const auto& [value, slope] = here.of[i];
    const Vector rest = across(slope, std::span(axis).first(i));
    const double far = length(rest);
    if (!(far > kLeastSine * length(slope))) return std::nullopt;
    axis[i] = times(1 / far, rest);
    const double wanted = (levels[i] - value - dot(slope, step)) / far;
    step = {step.x + wanted * axis[i].x, step.y + wanted * axis[i].y,
            step.z + wanted * axis[i].z};
  }
  return step;
}

std::optional<WorldPoint> InterfaceProjector::project(const WorldPoint& p,
                                                      const Levels& levels) {
  constexpr int kSteps = 8;
  constexpr double kLongestStep = 0.5;
  WorldPoint at = lattice_of(p);
  const WorldPoint from = at;
  for (int i = 0; i < kSteps; ++i) {
    std::optional<Vector> step = step_to(slopes_at(at), levels);
    if (!step) return std::nullopt;
    const double far = length(*step);
    if (!(far < 2 * InterfaceProbe::kReach)) return std::nullopt;
    if (far > kLongestStep) step = times(kLongestStep / far, *step);
    at = moved(at, *step);
    const Vector way = from_to(from, at);
    if (!(length(way) < InterfaceProbe::kReach / 2)) return std::nullopt;
    if (far <= kTolerance) return stored_of(at);
  }
  return std::nullopt;
}

}  // namespace tet
