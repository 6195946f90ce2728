// Indicators at all nodes of a brick and its halo at once, by separable sums.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/types.h"
#include "core/labels/kernel_taps.h"
#include "core/labels/label.h"
#include "core/lattice/bcc.h"

namespace tet {

/// The voxels that matter to a brick and its halo, z fastest, then y, then x.
struct VoxelWindow {
  VoxelBox box;
  std::array<std::size_t, 3> size{};

  void go_to(const std::array<std::array<TapRow, 3>, kNodeKinds>& taps) noexcept;
  std::size_t voxels() const noexcept { return size[0] * size[1] * size[2]; }
};

/// Values of nodes of one kind, by halo index.
using HaloField = std::array<float, kHaloNodes>;

/// Sums along x, then y, then z, each from the first tap to the last: so whoever sums a single
/// node in that order gets the same bits.
class Convolution {
 public:
  /// Enters the voxels of a label; `voxel` has those of the window.
  void choose(std::span<const Label> voxel, const VoxelWindow& window, Label label);
  /// Fills in the label's indicator at nodes [-2, 9]^3; the rest of `out` is unspecified.
  void run(const std::array<TapRow, 3>& taps, HaloField& out) noexcept;

 private:
  void sum_rows_of(const TapRow& by_y, const TapRow& by_z, float* out) noexcept;

  VoxelWindow window_;
  std::size_t row_ = 0;  // floats of a padded row of voxels
  std::vector<float> mask_, along_x_, along_y_;
};

}  // namespace tet
