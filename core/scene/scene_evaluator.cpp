#include "core/scene/scene_evaluator.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/scene/operators.h"
#include "core/scene/primitives.h"

namespace tet {

using scene::Instruction;
using scene::Op;

namespace {

scene::Points one_point(const WorldPoint& p) noexcept {
  scene::Points points;
  points.x[0] = p.x;
  points.y[0] = p.y;
  points.z[0] = p.z;
  return points;
}

}  // namespace

SceneEvaluator::SceneEvaluator(const Scene& scene)
    : scene_(&scene),
      all_(scene.program.size()),
      stack_(scene.stack_depth + 1),
      values_(scene.program.size()),
      wanted_(scene.program.size()) {
  std::iota(all_.begin(), all_.end(), 0U);
  active_ = all_;
}

/// The program's values at a point, one instruction after another.
void SceneEvaluator::evaluate_each(const WorldPoint& p) noexcept {
  const scene::Points points = one_point(p);
  scene::Values left, right;
  for (std::uint32_t i = 0; i < values_.size(); ++i) {
    const Instruction& op = scene_->program[i];
    if (is_leaf(op.op)) {
      evaluate_leaf(op, points, 1, left);
    } else if (is_binary(op.op)) {
      left.at[0] = values_[left_of(i)];
      right.at[0] = values_[i - 1];
      apply_binary(op, 1, left, right);
    } else {
      left.at[0] = values_[i - 1];
      apply_unary(op, 1, left);
    }
    values_[i] = left.at[0];
  }
}

std::uint32_t SceneEvaluator::only_part(std::uint32_t op,
                                        double reach,
                                        double rounding) const noexcept {
  const Instruction& binary = scene_->program[op];
  const std::uint32_t left = left_of(op), right = op - 1;
  const double sign = binary.op == Op::kMin ? 1 : -1;
  const double a = sign * values_[left], b = sign * values_[right];
  // Either value moves by as much as the point does; beyond the blend nothing is left of the
  // other.
  const double matters = binary.size[0] + 2 * reach + rounding * (std::abs(a) + std::abs(b));
  if (b - a > matters) return left + 1;
  return a - b > matters ? right + 1 : 0;
}

void SceneEvaluator::focus(const WorldPoint& centre, double reach) noexcept {
  if (scene_->program.size() == 1) return;
  centre_ = centre;
  reach_ = reach;
  evaluate_each(centre);
  // Far more than the values' own errors: whoever is left out must not matter by a single bit.
  constexpr double kRounding = 1e-9;
  const double room = reach + kRounding * (reach + std::abs(centre.x) + std::abs(centre.y) +
                                           std::abs(centre.z));
  std::fill(wanted_.begin(), wanted_.end(), false);
  wanted_.back() = true;
  active_.clear();
  for (auto i = static_cast<std::uint32_t>(wanted_.size()); i-- > 0;) {
    if (!wanted_[i]) continue;
    const Op op = scene_->program[i].op;
    const std::uint32_t only = is_binary(op) ? only_part(i, room, kRounding) : 0;
    if (only != 0) {
      wanted_[only - 1] = true;
      continue;
    }
    active_.push_back(i);
    if (!is_leaf(op)) wanted_[i - 1] = true;
    if (is_binary(op)) wanted_[left_of(i)] = true;
  }
  std::reverse(active_.begin(), active_.end());
}

bool SceneEvaluator::same_in_focus(const SceneEvaluator& other) const noexcept {
  return std::ranges::equal(active_, other.active_, [&](std::uint32_t a, std::uint32_t b) {
    return scene::same_values(scene_->program[a], other.scene_->program[b]);
  });
}

const double* SceneEvaluator::run(const std::vector<std::uint32_t>& program,
                                  const scene::Points& points,
                                  std::size_t count) noexcept {
  scene::Values* top = stack_.data();  // one below the last column
  for (const std::uint32_t i : program) {
    const Instruction& op = scene_->program[i];
    if (is_leaf(op.op)) {
      evaluate_leaf(op, points, count, *++top);
    } else if (is_binary(op.op)) {
      --top;
      apply_binary(op, count, *top, top[1]);
    } else {
      apply_unary(op, count, *top);
    }
  }
  return top->at.data();
}

const double* SceneEvaluator::evaluate(const scene::Points& points,
                                       std::size_t count) noexcept {
  return run(active_, points, count);
}

double SceneEvaluator::at(const WorldPoint& p) noexcept {
  const double x = p.x - centre_.x, y = p.y - centre_.y, z = p.z - centre_.z;
  const bool in_focus = x * x + y * y + z * z <= reach_ * reach_;
  return *run(in_focus ? active_ : all_, one_point(p), 1);
}

}  // namespace tet
