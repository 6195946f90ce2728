#include "core/scene/scene_bounds.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/scene/operators.h"

namespace tet::scene {
namespace {

/// Replaces bounds of phi by bounds of its magnitude, which is the same on both sides.
void bound_sizes(std::size_t count, PhiBounds& bounds) noexcept {
  for (std::size_t i = 0; i < count; ++i) {
    const double low = bounds.low.at[i], high = bounds.high.at[i];
    bounds.low.at[i] = std::max(0.0, std::max(low, -high));
    bounds.high.at[i] = std::max(-low, high);
  }
}

}  // namespace

void bound_primitive(double half_edge, std::size_t count, PhiBounds& bounds) noexcept {
  // A little more than half the diagonal, for rounding errors.
  const double reach = half_edge * std::numbers::sqrt3 * (1 + 2e-9);
  for (std::size_t i = 0; i < count; ++i) {
    bounds.high.at[i] = bounds.low.at[i] + reach;
    bounds.low.at[i] -= reach;
  }
}

void bound_unary(const Instruction& op, std::size_t count, PhiBounds& bounds) noexcept {
  if (op.op == Op::kNegate) std::swap(bounds.low, bounds.high);
  if (op.op == Op::kShell) bound_sizes(count, bounds);
  apply_unary(op, count, bounds.low);
  apply_unary(op, count, bounds.high);
}

void bound_binary(const Instruction& op,
                  std::size_t count,
                  PhiBounds& left,
                  const PhiBounds& right) noexcept {
  apply_binary(op, count, left.low, right.low);
  apply_binary(op, count, left.high, right.high);
}

}  // namespace tet::scene
