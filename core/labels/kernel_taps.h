// The weights of a row of voxels at a point among them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/labels/indicators.h"

namespace tet {

/// Weights of voxels in a row, which sum to one: `weight[i]` is that of voxel first + i.
struct Taps {
  std::int32_t first = 0;
  std::size_t count = 0;
  std::size_t begin = 0;  ///< of its weights, in TapRow::weights
};

/// Taps of the nodes of one kind along one axis of a brick and its halo: nodes -2 to 9. They
/// depend on a node's own coordinate alone, whichever brick sees it.
struct TapRow {
  static constexpr int kNodes = 12;
  std::array<Taps, kNodes> node;
  std::vector<float> weights;
  bool alike = false;  ///< each node's weights are those of the one before, one voxel further

  std::span<const float> weights_of(int i) const noexcept {
    const Taps& taps = node[static_cast<std::size_t>(i)];
    return std::span(weights).subspan(taps.begin, taps.count);
  }
};

/// Fills in the taps of nodes at `spacing` * (`first` + i), i in [0, 12), in voxels.
void find_taps(const IndicatorRules& rules, double spacing, double first, TapRow& row);

}  // namespace tet
