#include "core/labels/kernel_taps.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace tet {
namespace {

/// A kernel along one axis: an even function that vanishes from `reach` on.
struct AxisKernel {
  LabelKernel kind;
  double scale;  ///< voxels: a Gaussian's width, and what the others are stretched by
  double reach;

  AxisKernel(const IndicatorRules& rules, double spacing) noexcept
      : kind(rules.kernel),
        scale(kind == LabelKernel::kGauss ? gaussian_width(rules.smooth, spacing)
                                          : std::max(1.0, spacing)),
        // A voxel just at the end is in, however that was rounded.
        reach(kernel_reach(kind, rules.smooth, spacing) + 1e-9) {}

  double at(double distance) const noexcept {
    const double x = std::abs(distance) / scale;
    switch (kind) {
      case LabelKernel::kTrilinear:
        return std::max(0.0, 1 - x);
      case LabelKernel::kQuadratic:
        return x < 0.5 ? 0.75 - x * x : x < 1.5 ? 0.5 * (1.5 - x) * (1.5 - x) : 0;
      case LabelKernel::kGauss:
        break;
    }
    return std::abs(distance) <= reach ? std::exp(-0.5 * x * x) : 0;
  }
};

/// Whether each node's weights are those of the first, as many voxels further as it is.
bool are_alike(const TapRow& row) noexcept {
  const std::span<const float> first = row.weights_of(0);
  for (int i = 1; i < TapRow::kNodes; ++i) {
    if (row.node[static_cast<std::size_t>(i)].first != row.node[0].first + i) return false;
    if (!std::ranges::equal(row.weights_of(i), first)) return false;
  }
  return true;
}

}  // namespace

void find_taps(const IndicatorRules& rules, double spacing, double first, TapRow& row) {
  const AxisKernel kernel(rules, spacing);
  row.weights.clear();
  std::vector<double> weights;
  for (int i = 0; i < TapRow::kNodes; ++i) {
    const double at = spacing * (first + i);
    auto low = static_cast<std::int32_t>(std::ceil(at - kernel.reach));
    const auto high = static_cast<std::int32_t>(std::floor(at + kernel.reach));
    weights.clear();
    double sum = 0;
    for (std::int32_t voxel = low; voxel <= high; ++voxel) {
      weights.push_back(kernel.at(voxel - at));
      sum += weights.back();
    }
    // Voxels at the very end of a kernel weigh nothing.
    while (weights.back() == 0) weights.pop_back();
    std::size_t nothing = 0;
    while (weights[nothing] == 0) ++nothing;
    row.node[static_cast<std::size_t>(i)] = {low + static_cast<std::int32_t>(nothing),
                                             weights.size() - nothing, row.weights.size()};
    for (std::size_t w = nothing; w < weights.size(); ++w) {
      row.weights.push_back(static_cast<float>(weights[w] / sum));
    }
  }
  row.alike = are_alike(row);
}

}  // namespace tet
