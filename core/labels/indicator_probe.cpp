#include "core/labels/indicator_probe.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tet {
namespace {

/// Voxels that a kernel reaches over to either side before some stand for others.
constexpr double kMostReach = 24;

/// Adds a row of voxels to sums of them.
void add_row(const float* __restrict row,
             std::size_t count,
             const std::array<float, 3>& factor,
             float* __restrict sum,
             float* __restrict sum_x,
             float* __restrict sum_y) noexcept {
  const auto [f, fx, fy] = factor;
  for (std::size_t i = 0; i < count; ++i) {
    sum[i] += f * row[i];
    sum_x[i] += fx * row[i];
    sum_y[i] += fy * row[i];
  }
}

double dot_of(const std::vector<float>& a, const std::vector<float>& b) noexcept {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    sum += static_cast<double>(a[i]) * static_cast<double>(b[i]);
  }
  return sum;
}

}  // namespace

IndicatorProbe::IndicatorProbe(const LabelVoxels& voxels, const IndicatorRules& rules)
    : voxels_(voxels), rules_(rules) {
  for (std::size_t i = 0; i < 3; ++i) axis_[i] = axis_of(rules.spacing_voxels[i]);
}

IndicatorProbe::Axis IndicatorProbe::axis_of(double spacing) const noexcept {
  Axis axis;
  axis.spacing = spacing;
  const double step = std::max(1.0, spacing);
  switch (rules_.kernel) {
    case LabelKernel::kTrilinear:
      axis.scale = axis.reach = step;
      break;
    case LabelKernel::kQuadratic:
      axis.scale = step;
      axis.reach = 1.5 * step;
      break;
    case LabelKernel::kGauss: {
      constexpr double kWidths = 4;
      axis.scale = gaussian_width(rules_.smooth, spacing);
      axis.reach = std::max(1.0, kWidths * axis.scale);
      const double widths = axis.reach / axis.scale;
      axis.left = std::exp(-0.5 * widths * widths);
      break;
    }
  }
  axis.stride = std::max(1, static_cast<std::int32_t>(axis.reach / kMostReach));
  return axis;
}

ValueSlope IndicatorProbe::kernel(const Axis& axis, double distance) const noexcept {
  const double x = std::abs(distance) / axis.scale;
  const double per_voxel = (distance < 0 ? -1 : 1) / axis.scale;
  switch (rules_.kernel) {
    case LabelKernel::kTrilinear:
      if (x < 1) return {1 - x, {-per_voxel, 0, 0}};
      break;
    case LabelKernel::kQuadratic:
      if (x < 0.5) return {0.75 - x * x, {-2 * x * per_voxel, 0, 0}};
      if (x < 1.5) return {0.5 * (1.5 - x) * (1.5 - x), {(x - 1.5) * per_voxel, 0, 0}};
      break;
    case LabelKernel::kGauss:
      if (std::abs(distance) < axis.reach) {
        const double value = std::exp(-0.5 * x * x);
        return {value - axis.left, {-x * value * per_voxel, 0, 0}};
      }
      break;
  }
  return {};
}

/// Weights sum to one, and their slopes to nothing.
void IndicatorProbe::find_taps(const Axis& axis, double at, ProbeTaps& taps) const {
  const double stride = axis.stride;
  const auto low = static_cast<std::int32_t>(std::ceil((at - axis.reach) / stride)),
             high = static_cast<std::int32_t>(std::floor((at + axis.reach) / stride));
  taps.first = low;
  taps.weight.clear();
  taps.slope.clear();
  double sum = 0, sum_slope = 0;
  for (std::int32_t voxel = low; voxel <= high; ++voxel) {
    // A point that goes up by as much comes nearer by that.
    const ValueSlope weight = kernel(axis, at - stride * voxel);
    // Rounded before they are summed: the last bits of exp are not everywhere the same.
    taps.weight.push_back(static_cast<float>(weight.value));
    taps.slope.push_back(static_cast<float>(weight.slope.x));
    sum += static_cast<double>(taps.weight.back());
    sum_slope += static_cast<double>(taps.slope.back());
  }
  for (std::size_t i = 0; i < taps.weight.size(); ++i) {
    const double weight = static_cast<double>(taps.weight[i]) / sum;
    taps.weight[i] = static_cast<float>(weight);
    taps.slope[i] = static_cast<float>(
        (static_cast<double>(taps.slope[i]) - weight * sum_slope) / sum * axis.spacing);
  }
}

bool IndicatorProbe::choose(std::span<const Label> labels, const WorldPoint& near) {
  const std::array<double, 3> at{near.x, near.y, near.z};
  for (std::size_t i = 0; i < 3; ++i) {
    const Axis& axis = axis_[i];
    const double middle = at[i] * axis.spacing, half = kReach * axis.spacing + axis.reach;
    first_[i] = static_cast<std::int32_t>(std::floor((middle - half) / axis.stride));
    size_[i] =
        static_cast<std::size_t>(std::ceil((middle + half) / axis.stride) - first_[i] + 1);
  }
  functions_ = labels.size() - 1;
  voxel_.resize(size_[0] * size_[1] * size_[2]);
  copy_window();
  for (std::size_t f = 0; f < functions_; ++f) {
    difference_[f].resize(voxel_.size());
    for (std::size_t v = 0; v < voxel_.size(); ++v) {
      const Label label = voxel_[v];
      difference_[f][v] = label == labels[0] ? 1.0F : label == labels[f + 1] ? -1.0F : 0.0F;
    }
  }
  return true;
}

/// Copies the voxels of the window; of every stride one.
void IndicatorProbe::copy_window() {
  const auto voxel = [&](std::size_t axis, std::size_t i) {
    return (first_[axis] + static_cast<std::int32_t>(i)) * axis_[axis].stride;
  };
  if (axis_[0].stride == 1 && axis_[1].stride == 1 && axis_[2].stride == 1) {
    voxels_.copy({{voxel(0, 0), voxel(1, 0), voxel(2, 0)},
                  {voxel(0, size_[0] - 1), voxel(1, size_[1] - 1), voxel(2, size_[2] - 1)}},
                 voxel_.data());
    return;
  }
  const auto stride = static_cast<std::size_t>(axis_[2].stride);
  line_.resize((size_[2] - 1) * stride + 1);
  Label* out = voxel_.data();
  for (std::size_t x = 0; x < size_[0]; ++x) {
    for (std::size_t y = 0; y < size_[1]; ++y) {
      voxels_.copy({{voxel(0, x), voxel(1, y), voxel(2, 0)},
                    {voxel(0, x), voxel(1, y), voxel(2, size_[2] - 1)}},
                   line_.data());
      for (std::size_t z = 0; z < size_[2]; ++z) *out++ = line_[z * stride];
    }
  }
}

bool IndicatorProbe::is_within(std::size_t axis, const ProbeTaps& taps) const noexcept {
  const std::int64_t from = std::int64_t{taps.first} - first_[axis];
  return from >= 0 && static_cast<std::size_t>(from) + taps.weight.size() <= size_[axis];
}

void IndicatorProbe::at(const WorldPoint& p, std::span<ValueSlope> out) {
  const std::array<double, 3> at{p.x, p.y, p.z};
  for (std::size_t i = 0; i < 3; ++i) {
    find_taps(axis_[i], at[i] * axis_[i].spacing, taps_[i]);
    if (is_within(i, taps_[i])) continue;
    std::ranges::fill(out, ValueSlope{std::numeric_limits<double>::quiet_NaN(), {}});
    return;
  }
  for (std::size_t f = 0; f < out.size(); ++f) out[f] = sum_of(f);
}

ValueSlope IndicatorProbe::sum_of(std::size_t function) {
  const auto& [tx, ty, tz] = taps_;
  const std::size_t count = tz.weight.size();
  for (std::vector<float>* row : {&row_, &row_x_, &row_y_}) row->assign(count, 0.0F);
  const auto from = [&](std::size_t axis) {
    return static_cast<std::size_t>(taps_[axis].first - first_[axis]);
  };
  for (std::size_t x = 0; x < tx.weight.size(); ++x) {
    for (std::size_t y = 0; y < ty.weight.size(); ++y) {
      const float* const row = difference_[function].data() +
                               ((from(0) + x) * size_[1] + from(1) + y) * size_[2] + from(2);
      const float wx = tx.weight[x], wy = ty.weight[y];
      add_row(row, count, {wx * wy, tx.slope[x] * wy, wx * ty.slope[y]}, row_.data(),
              row_x_.data(), row_y_.data());
    }
  }
  return {dot_of(row_, tz.weight),
          {dot_of(row_x_, tz.weight), dot_of(row_y_, tz.weight), dot_of(row_, tz.slope)}};
}

}  // namespace tet
