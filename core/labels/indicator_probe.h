// Indicators of labels of voxels at any point, and how fast they change there.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/base/types.h"
#include "core/labels/indicators.h"
#include "core/labels/interface_probe.h"

namespace tet {

/// The weights of a row of voxels at a point among them, and how fast they change with it.
struct ProbeTaps {
  std::int32_t first = 0;  ///< voxel, in strides
  std::vector<float> weight, slope;
};

/// Differences of indicators, from that of the first label that was chosen.
///
/// The kernels are those of the nodes. The Gaussian, which nodes see up to a few widths away,
/// would jump there between them: here it is cut off at four of its widths, less what it has
/// left there, so that it ends at zero. At nodes the two differ by a few thousandths. Where a
/// kernel reaches over more voxels than are worth it, every second, or third, stands for all.
class IndicatorProbe final : public InterfaceProbe {
 public:
  IndicatorProbe(const LabelVoxels& voxels, const IndicatorRules& rules);

  bool choose(std::span<const Label> labels, const WorldPoint& near) override;
  void at(const WorldPoint& p, std::span<ValueSlope> out) override;

 private:
  /// The kernel along one axis.
  struct Axis {
    double spacing = 1;  ///< of the lattice, voxels
    double scale = 1;    ///< voxels: the Gaussian's width, and what others are stretched by
    double reach = 1;    ///< beyond which it is zero
    double left = 0;     ///< of the Gaussian, at its reach
    std::int32_t stride = 1;  ///< voxels
  };

  Axis axis_of(double spacing) const noexcept;
  ValueSlope kernel(const Axis& axis, double distance) const noexcept;
  void copy_window();
  void find_taps(const Axis& axis, double at, ProbeTaps& taps) const;
  bool is_within(std::size_t axis, const ProbeTaps& taps) const noexcept;
  ValueSlope sum_of(std::size_t function);

  const LabelVoxels& voxels_;
  const IndicatorRules rules_;
  std::array<Axis, 3> axis_;

  // These belong to what was chosen.
  std::array<std::int32_t, 3> first_{};  // voxel of the window, in strides
  std::array<std::size_t, 3> size_{};
  std::size_t functions_ = 0;
  std::vector<Label> voxel_, line_;
  std::array<std::vector<float>, kMostMeeting - 1> difference_;  // at each voxel of the window

  std::array<ProbeTaps, 3> taps_;
  std::vector<float> row_, row_x_, row_y_;
};

}  // namespace tet
