// Indicators where there are many labels: each node sums those that it sees, and no others.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/brick_mask.h"
#include "core/base/cancel.h"
#include "core/labels/convolve.h"
#include "core/labels/kernel_taps.h"
#include "core/labels/label.h"

namespace tet {

/// Sums of weights, by the places of labels; of which few are not zero.
class LabelSums {
 public:
  void resize(std::size_t labels) {
    sum_.assign(labels, {});
    seen_.resize(labels);
    count_ = 0;
  }
  void add(std::uint16_t place, float by) noexcept {
    Sum& sum = sum_[place];
    if (!sum.is_seen) {
      sum.is_seen = true;
      seen_[count_++] = place;
    }
    sum.value += by;
  }
  /// 0 of a label that nothing was added to.
  float of(std::uint16_t place) const noexcept { return sum_[place].value; }
  /// Places of labels that something was added to.
  std::span<const std::uint16_t> seen() const noexcept { return {seen_.data(), count_}; }
  void clear() noexcept {
    for (const std::uint16_t place : seen()) sum_[place] = {};
    count_ = 0;
  }

 private:
  struct Sum {
    float value = 0;
    bool is_seen = false;
  };

  std::vector<Sum> sum_;
  std::vector<std::uint16_t> seen_;
  std::size_t count_ = 0;
};

/// The sums that `Convolution` makes, to the bit: along x, then y, then z, each from the first
/// tap to the last. What adds nothing is left out, so that it takes as long as there are
/// voxels, however many labels they have.
class SparseSums {
 public:
  /// Takes the voxels of a window, whose labels are `labels`: ascending.
  void enter(std::span<const Label> voxel,
             const VoxelWindow& window,
             std::span<const Label> labels);

  /// Calls `visit(node, sums)` for nodes in [-2, 9]^3, by halo index in increasing order. Where
  /// it finds that it is cancelled it leaves out the rest.
  template <class Visit>
  void for_each_node(const std::array<TapRow, 3>& taps,
                     const HaloSet& nodes,
                     const Cancellation& cancellation,
                     const Visit& visit) {
    begin(taps);
    for (int x = 0; x < TapRow::kNodes; ++x) {
      begin_slice();
      for (int y = 0; y < TapRow::kNodes; ++y) {
        const int first = halo_index(x - 2, y - 2, -2);
        std::uint64_t row = nodes.word[static_cast<std::size_t>(first >> 6)] >> (first & 63) &
                            ((1U << TapRow::kNodes) - 1);
        if (row == 0) continue;
        // Rows of the largest windows take a few milliseconds.
        if (cancellation.requested()) return;
        sum_along_y(taps[0], x, taps[1], y);
        for (; row != 0; row &= row - 1) {
          const int z = std::countr_zero(row);
          sum_along_z(taps[2], z);
          visit(first + z, sums_);
          sums_.clear();
        }
      }
    }
  }

 private:
  struct Share {
    std::uint16_t place;
    float sum;
  };
  /// What labels have of each of a row of sums along z.
  struct Row {
    std::vector<std::uint32_t> first;  ///< one more than sums
    std::vector<Share> share;

    void clear() noexcept;
    /// Appends a sum, and clears it.
    void take(LabelSums& sums);
    std::span<const Share> at(std::size_t z) const noexcept {
      return std::span(share).subspan(first[z], first[z + 1] - first[z]);
    }
  };

  void begin(const std::array<TapRow, 3>& taps);
  void begin_slice() noexcept;
  void sum_along_x(const TapRow& by, int x, std::size_t y, Row& row);
  void sum_along_y(const TapRow& by_x, int x, const TapRow& by, int y);
  void sum_along_z(const TapRow& by, int z) noexcept;

  VoxelWindow window_;
  std::vector<std::uint16_t> place_of_;  // by label
  std::vector<std::uint16_t> place_;     // of voxels, x fastest, then z, then y
  LabelSums sums_;

  // Rows of one slice along x, as many as a node reaches over or more: y at y % rows_.size().
  std::vector<Row> rows_;
  std::vector<std::size_t> held_;  // the y that each is of
  Row sums_of_row_;                // along x and y, at each z
};

}  // namespace tet
