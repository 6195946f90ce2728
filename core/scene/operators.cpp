#include "core/scene/operators.h"

#include <cmath>

#include "core/base/vector_clones.h"

namespace tet::scene {
namespace {

TET_VECTOR_CLONES
void negate(std::size_t count, Values& values) noexcept {
  for (std::size_t i = 0; i < count; ++i) values.at[i] = -values.at[i];
}

TET_VECTOR_CLONES
void offset(double distance, std::size_t count, Values& values) noexcept {
  for (std::size_t i = 0; i < count; ++i) values.at[i] -= distance;
}

TET_VECTOR_CLONES
void shell(double half_thickness, std::size_t count, Values& values) noexcept {
  for (std::size_t i = 0; i < count; ++i)
    values.at[i] = std::abs(values.at[i]) - half_thickness;
}

TET_VECTOR_CLONES
void take_smaller(std::size_t count, Values& left, const Values& right) noexcept {
  for (std::size_t i = 0; i < count; ++i) {
    const double a = left.at[i], b = right.at[i];
    left.at[i] = a < b ? a : b;
  }
}

TET_VECTOR_CLONES
void take_larger(std::size_t count, Values& left, const Values& right) noexcept {
  for (std::size_t i = 0; i < count; ++i) {
    const double a = left.at[i], b = right.at[i];
    left.at[i] = a > b ? a : b;
  }
}

/// `sign` is 1 for the smaller and -1 for the larger value.
TET_VECTOR_CLONES
void blend(
    double sign, double k, std::size_t count, Values& left, const Values& right) noexcept {
  const double per_4k = 0.25 / k;
  for (std::size_t i = 0; i < count; ++i) {
    const double a = sign * left.at[i], b = sign * right.at[i];
    const double near = k - std::abs(a - b), h = near > 0 ? near : 0;
    left.at[i] = sign * ((a < b ? a : b) - h * h * per_4k);
  }
}

}  // namespace

void apply_unary(const Instruction& op, std::size_t count, Values& values) noexcept {
  switch (op.op) {
    case Op::kNegate:
      return negate(count, values);
    case Op::kOffset:
      return offset(op.size[0], count, values);
    case Op::kShell:
      return shell(op.size[0], count, values);
    default:
      return;
  }
}

void apply_binary(const Instruction& op,
                  std::size_t count,
                  Values& left,
                  const Values& right) noexcept {
  const double smoothing = op.size[0];
  const bool smaller = op.op == Op::kMin;
  if (smoothing > 0) return blend(smaller ? 1 : -1, smoothing, count, left, right);
  smaller ? take_smaller(count, left, right) : take_larger(count, left, right);
}

}  // namespace tet::scene
