#include "core/scene/scene_evaluator.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

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
      leaves_(scene.stack_depth + 1),
      bounds_stack_(scene.stack_depth + 1),
      intervals_(scene.program.size()),
      wanted_(scene.program.size()) {
  std::iota(all_.begin(), all_.end(), 0U);
  active_ = all_;
  for (const scene::GridSource& grid : scene.grids) grids_.emplace_back(grid);
}

void SceneEvaluator::evaluate_leaf(const Instruction& leaf,
                                   const scene::Points& points,
                                   std::size_t count,
                                   scene::Values& values) noexcept {
  if (leaf.op == Op::kGrid) return grids_[leaf.grid].evaluate(leaf, points, count, values);
  evaluate_primitive(leaf, points, count, values);
}

void SceneEvaluator::bound_leaf(const Instruction& leaf,
                                const scene::Points& points,
                                std::size_t count,
                                double half_edge,
                                scene::PhiBounds& bounds) noexcept {
  if (leaf.op == Op::kGrid) {
    return grids_[leaf.grid].bound(leaf, points, count, half_edge, bounds.low, bounds.high);
  }
  evaluate_primitive(leaf, points, count, bounds.low);
  bound_primitive(half_edge, count, bounds);
}

/// The program's values around the focus, one instruction after another.
void SceneEvaluator::bound_each(double half_edge) noexcept {
  const scene::Points points = one_point(centre_);
  scene::PhiBounds &left = bounds_stack_[0], &right = bounds_stack_[1];
  const auto load = [&](std::uint32_t i, scene::PhiBounds& bounds) {
    bounds.low.at[0] = intervals_[i].low;
    bounds.high.at[0] = intervals_[i].high;
  };
  for (std::uint32_t i = 0; i < intervals_.size(); ++i) {
    const Instruction& op = scene_->program[i];
    if (is_leaf(op.op)) {
      bound_leaf(op, points, 1, half_edge, left);
    } else if (is_binary(op.op)) {
      load(left_of(i), left);
      load(i - 1, right);
      bound_binary(op, 1, left, right);
    } else {
      load(i - 1, left);
      bound_unary(op, 1, left);
    }
    intervals_[i] = {left.low.at[0], left.high.at[0]};
  }
}

std::uint32_t SceneEvaluator::only_part(std::uint32_t op, double rounding) const noexcept {
  const Instruction& binary = scene_->program[op];
  const std::uint32_t left = left_of(op), right = op - 1;
  const bool smaller = binary.op == Op::kMin;
  // Beyond the blend nothing is left of the one that is farther from being chosen.
  const auto alone = [&](const Interval& one, const Interval& other) {
    const double apart = smaller ? other.low - one.high : one.low - other.high;
    const double size = std::max(std::abs(one.low), std::abs(one.high)) +
                        std::max(std::abs(other.low), std::abs(other.high));
    return apart > binary.size[0] + rounding * size;
  };
  if (alone(intervals_[left], intervals_[right])) return left + 1;
  return alone(intervals_[right], intervals_[left]) ? right + 1 : 0;
}

void SceneEvaluator::focus(const WorldPoint& centre, double half_edge) noexcept {
  focus_program(centre, half_edge);
  for (const std::uint32_t i : active_) {
    const Instruction& op = scene_->program[i];
    if (op.op == Op::kGrid) grids_[op.grid].focus(op, centre, half_edge);
  }
}

void SceneEvaluator::focus_program(const WorldPoint& centre, double half_edge) noexcept {
  if (scene_->program.size() == 1 || stops(scene_->program.size())) return;
  centre_ = centre;
  half_edge_ = half_edge;
  // Far more than the values' own errors: whoever is left out must not matter by a single bit.
  constexpr double kRounding = 1e-9;
  bound_each(half_edge + kRounding * (half_edge + std::abs(centre.x) + std::abs(centre.y) +
                                      std::abs(centre.z)));
  std::fill(wanted_.begin(), wanted_.end(), false);
  wanted_.back() = true;
  active_.clear();
  for (auto i = static_cast<std::uint32_t>(wanted_.size()); i-- > 0;) {
    if (!wanted_[i]) continue;
    const Op op = scene_->program[i].op;
    const std::uint32_t only = is_binary(op) ? only_part(i, kRounding) : 0;
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
  return std::ranges::equal(active_, other.active_, [&](std::uint32_t i, std::uint32_t j) {
    const Instruction &a = scene_->program[i], &b = other.scene_->program[j];
    if (!scene::same_values(a, b)) return false;
    return a.op != Op::kGrid ||
           scene_->grids[a.grid].volume == other.scene_->grids[b.grid].volume;
  });
}

bool SceneEvaluator::stops(std::size_t values) noexcept {
  since_look_ += values;
  if (stopped_ || cancellation_ == nullptr || since_look_ < kValuesPerLook) return stopped_;
  since_look_ = 0;
  stopped_ = cancellation_->requested();
  return stopped_;
}

template <class Body>
bool SceneEvaluator::for_each_instruction(const std::vector<std::uint32_t>& program,
                                          std::size_t count,
                                          const Body& body) noexcept {
  for (std::span<const std::uint32_t> left(program); !left.empty();) {
    const auto some = left.first(std::min(kInstructionsAtOnce, left.size()));
    if (stops(some.size() * count)) return false;
    for (const std::uint32_t i : some) body(scene_->program[i]);
    left = left.subspan(some.size());
  }
  return true;
}

const double* SceneEvaluator::run(const std::vector<std::uint32_t>& program,
                                  const scene::Points& points,
                                  std::size_t count) noexcept {
  scene::Values* top = stack_.data();  // one below the last column
  const bool done = for_each_instruction(program, count, [&](const Instruction& op) {
    if (is_leaf(op.op)) {
      evaluate_leaf(op, points, count, *++top);
    } else if (is_binary(op.op)) {
      --top;
      apply_binary(op, count, *top, top[1]);
    } else {
      apply_unary(op, count, *top);
    }
  });
  if (!done) {
    top = stack_.data();
    std::fill_n(top->at.begin(), count, 1.0);
  }
  return top->at.data();
}

const double* SceneEvaluator::evaluate(const scene::Points& points,
                                       std::size_t count) noexcept {
  return run(active_, points, count);
}

const scene::PhiBounds& SceneEvaluator::bounds(const scene::Points& points,
                                               std::size_t count,
                                               double half_edge) noexcept {
  scene::PhiBounds* top = bounds_stack_.data();  // as in `run`
  const bool done = for_each_instruction(active_, count, [&](const Instruction& op) {
    if (is_leaf(op.op)) {
      bound_leaf(op, points, count, half_edge, *++top);
    } else if (is_binary(op.op)) {
      --top;
      bound_binary(op, count, *top, top[1]);
    } else {
      bound_unary(op, count, *top);
    }
  });
  if (!done) {
    top = bounds_stack_.data();
    std::fill_n(top->low.at.begin(), count, 1.0);
    std::fill_n(top->high.at.begin(), count, 1.0);
  }
  return *top;
}

const std::vector<std::uint32_t>& SceneEvaluator::program_at(
    const WorldPoint& p) const noexcept {
  const auto near = [&](double at, double middle) {
    return std::abs(at - middle) <= half_edge_;
  };
  const bool in_focus = near(p.x, centre_.x) && near(p.y, centre_.y) && near(p.z, centre_.z);
  return in_focus ? active_ : all_;
}

double SceneEvaluator::at(const WorldPoint& p) noexcept {
  return *run(program_at(p), one_point(p), 1);
}

std::uint32_t SceneEvaluator::leaf_at(const WorldPoint& p) noexcept {
  const scene::Points points = one_point(p);
  scene::Values* top = stack_.data();  // as in `run`
  std::uint32_t* leaf = leaves_.data();
  const bool done = for_each_instruction(program_at(p), 1, [&](const Instruction& op) {
    if (is_leaf(op.op)) {
      evaluate_leaf(op, points, 1, *++top);
      *++leaf = static_cast<std::uint32_t>(&op - scene_->program.data());
    } else if (is_binary(op.op)) {
      --top;
      --leaf;
      const double left = top->at[0], right = top[1].at[0];
      if (op.op == Op::kMin ? right < left : right > left) *leaf = leaf[1];
      apply_binary(op, 1, *top, top[1]);
    } else {
      apply_unary(op, 1, *top);
    }
  });
  return done ? *leaf : 0;
}

}  // namespace tet
