#include "core/labels/convolve.h"

#include <algorithm>
#include <cstring>
#include <type_traits>

#include "core/base/vector_clones.h"

namespace tet {
namespace {

/// Rows of voxels are padded to whole groups of lanes; a row of nodes is one group.
constexpr std::size_t kLanes = 16;
static_assert(TapRow::kNodes <= kLanes && halo_index(-2, -1, -2) == kLanes);

/// What is done to one lane is done to each; all stays within a function, as what a vector is
/// passed in depends on the processor.
using Lanes = float __attribute__((vector_size(kLanes * sizeof(float))));

std::size_t offset_of(std::int32_t voxel, std::int32_t first) noexcept {
  return static_cast<std::size_t>(voxel - first);
}

/// Weights, and how far apart lies what they weigh.
struct Weighted {
  std::span<const float> weight;
  std::size_t step = 1;
};

/// out = the sum over k of weight[k] * in[k * step], first to last, in each lane: over kTaps
/// weights, or for 0 over all.
template <std::size_t kTaps>
[[gnu::always_inline]] inline void sum_lanes(const Weighted& by,
                                             const float* in,
                                             float* out) noexcept {
  const std::size_t taps = kTaps != 0 ? kTaps : by.weight.size();
  Lanes sum{};
  for (std::size_t k = 0; k < taps; ++k) {
    Lanes value;
    std::memcpy(&value, in + k * by.step, sizeof(value));
    sum += by.weight[k] * value;
  }
  std::memcpy(out, &sum, sizeof(sum));
}

template <std::size_t kTaps>
[[gnu::always_inline]] inline void sum_groups(const Weighted& by,
                                              const float* in,
                                              std::size_t groups,
                                              float* out) noexcept {
  for (std::size_t g = 0; g < groups; ++g) {
    sum_lanes<kTaps>(by, in + g * kLanes, out + g * kLanes);
  }
}

/// Calls `sum` with the number of taps, where it is one of the usual, as a constant; else with
/// 0.
template <class Sum>
[[gnu::always_inline]] inline void with_taps(std::size_t taps, const Sum& sum) noexcept {
  switch (taps) {
    case 2:
      return sum(std::integral_constant<std::size_t, 2>());
    case 3:
      return sum(std::integral_constant<std::size_t, 3>());
    case 4:
      return sum(std::integral_constant<std::size_t, 4>());
    case 5:
      return sum(std::integral_constant<std::size_t, 5>());
    default:
      return sum(std::integral_constant<std::size_t, 0>());
  }
}

/// Sums whole groups of lanes.
TET_VECTOR_CLONES
void sum_rows(const Weighted& by, const float* in, std::size_t groups, float* out) noexcept {
  with_taps(
      by.weight.size(), [&](auto taps) __attribute__((always_inline)) {
        sum_groups<decltype(taps)::value>(by, in, groups, out);
      });
}

/// The rows of a slice that has one group of voxels a row, each with zeros beyond.
constexpr std::size_t kWideRow = 2 * kLanes;
using WideRows = std::array<float, kWideRow * TapRow::kNodes>;

template <std::size_t kTaps>
[[gnu::always_inline]] inline void sum_nodes_of_slice(const Weighted& y,
                                                      const Weighted& z,
                                                      const float* in,
                                                      std::size_t first_z,
                                                      float* out) noexcept {
  WideRows rows;
  // First all rows: what was just written is not ready to be read at another place.
  for (std::size_t i = 0; i < TapRow::kNodes; ++i) {
    sum_lanes<kTaps>(y, in + i * kLanes, rows.data() + i * kWideRow);
    std::memset(rows.data() + i * kWideRow + kLanes, 0, kLanes * sizeof(float));
  }
  for (std::size_t i = 0; i < TapRow::kNodes; ++i) {
    sum_lanes<kTaps>(z, rows.data() + i * kWideRow + first_z, out + i * kLanes);
  }
}

/// Sums a slice along y, then z, where all its nodes have the same weights.
TET_VECTOR_CLONES
void sum_slice(const Weighted& y,
               const Weighted& z,
               const float* in,
               std::size_t first_z,
               float* out) noexcept {
  const std::size_t both = y.weight.size() == z.weight.size() ? y.weight.size() : 0;
  with_taps(
      both, [&](auto taps) __attribute__((always_inline)) {
        sum_nodes_of_slice<decltype(taps)::value>(y, z, in, first_z, out);
      });
}

/// Sums one row along z where nodes have weights of their own.
void sum_nodes(const TapRow& taps,
               const float* row,
               std::int32_t first_voxel,
               float* out) noexcept {
  for (int z = 0; z < TapRow::kNodes; ++z) {
    const Taps& node = taps.node[static_cast<std::size_t>(z)];
    const float* const at = row + offset_of(node.first, first_voxel);
    const float* const weight = taps.weights.data() + node.begin;
    float sum = 0;
    for (std::size_t k = 0; k < node.count; ++k) sum += weight[k] * at[k];
    out[z] = sum;
  }
}

/// 1 where a voxel has the label, else 0. Rows of voxels become rows that are padded.
TET_VECTOR_CLONES
void mark_rows(const Label* voxel,
               std::size_t rows,
               std::size_t count,
               std::size_t padded,
               Label label,
               float* out) noexcept {
  for (std::size_t r = 0; r < rows; ++r, voxel += count, out += padded) {
    for (std::size_t i = 0; i < count; ++i) out[i] = voxel[i] == label ? 1.0F : 0.0F;
    for (std::size_t i = count; i < padded; ++i) out[i] = 0;
  }
}

}  // namespace

void VoxelWindow::go_to(const std::array<std::array<TapRow, 3>, kNodeKinds>& taps) noexcept {
  std::array<std::int32_t, 3> low, high;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low[axis] = INT32_MAX;
    high[axis] = INT32_MIN;
    for (const auto& rows : taps) {
      for (const Taps& node : rows[axis].node) {
        low[axis] = std::min(low[axis], node.first);
        high[axis] =
            std::max(high[axis], node.first + static_cast<std::int32_t>(node.count) - 1);
      }
    }
    size[axis] = static_cast<std::size_t>(high[axis] - low[axis] + 1);
  }
  box = {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
}

void Convolution::choose(std::span<const Label> voxel, const VoxelWindow& window, Label label) {
  window_ = window;
  const auto [nx, ny, nz] = window.size;
  row_ = (nz + kLanes - 1) / kLanes * kLanes;
  mask_.resize(nx * ny * row_);
  along_x_.resize(ny * row_);
  along_y_.assign(row_ + kLanes, 0);
  if (row_ == nz) {
    mark_rows(voxel.data(), 1, nx * ny * nz, nx * ny * nz, label, mask_.data());
  } else {
    mark_rows(voxel.data(), nx * ny, nz, row_, label, mask_.data());
  }
}

void Convolution::run(const std::array<TapRow, 3>& taps, HaloField& out) noexcept {
  const auto& [by_x, by_y, by_z] = taps;
  const std::size_t slice = window_.size[1] * row_;
  const std::size_t first_z = offset_of(by_z.node[0].first, window_.box.min.z);
  for (int x = 0; x < TapRow::kNodes; ++x) {
    const std::size_t first_x =
        offset_of(by_x.node[static_cast<std::size_t>(x)].first, window_.box.min.x);
    sum_rows({by_x.weights_of(x), slice}, mask_.data() + first_x * slice, slice / kLanes,
             along_x_.data());
    float* const row = out.data() + halo_index(x - 2, -2, -2);
    if (row_ == kLanes && by_y.alike && by_z.alike) {
      const std::size_t first_y = offset_of(by_y.node[0].first, window_.box.min.y);
      sum_slice({by_y.weights_of(0), row_}, {by_z.weights_of(0), 1},
                along_x_.data() + first_y * row_, first_z, row);
    } else {
      sum_rows_of(by_y, by_z, row);
    }
  }
}

void Convolution::sum_rows_of(const TapRow& by_y, const TapRow& by_z, float* out) noexcept {
  for (int y = 0; y < TapRow::kNodes; ++y, out += kLanes) {
    const std::size_t first_y =
        offset_of(by_y.node[static_cast<std::size_t>(y)].first, window_.box.min.y);
    sum_rows({by_y.weights_of(y), row_}, along_x_.data() + first_y * row_, row_ / kLanes,
             along_y_.data());
    sum_nodes(by_z, along_y_.data(), window_.box.min.z, out);
  }
}

}  // namespace tet
