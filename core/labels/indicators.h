// Labels of voxels as indicators: smooth functions that compete for each node of the lattice.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include "core/base/types.h"
#include "core/labels/label.h"
#include "core/labels/label_kernel.h"
#include "core/labels/label_samples.h"

namespace tet {

/// Labels of voxels, whatever they are kept in. Immutable: any thread may ask.
class LabelVoxels {
 public:
  virtual ~LabelVoxels() = default;
  /// The label of all voxels of a box, where that is told at small cost.
  virtual std::optional<Label> one_label(const VoxelBox& box) const = 0;
  /// Writes the labels of a box's voxels, z fastest, then y, then x.
  virtual void copy(const VoxelBox& box, Label* out) const = 0;
};

/// The lattice among the voxels, and the kernel.
struct IndicatorRules {
  std::array<double, 3> spacing_voxels{1, 1, 1};  ///< along each axis
  LabelKernel kernel = LabelKernel::kGauss;
  /// The Gaussian's width, voxels. On a lattice coarser than the voxels it is a root of a sum
  /// of squares, half a spacing much coarser.
  double smooth = kDefaultSmooth;
};

/// The indicator of a label is the sum of the weights of its voxels, and weights sum to one: so
/// labels compete fairly, no distances are computed, and only the labels around a node cost
/// anything. The largest indicator wins, of equal ones the lower label. An edge between A and B
/// is cut where the straight line between the differences of their indicators at its ends is
/// zero.
class IndicatorLabels final : public LabelSource {
 public:
  IndicatorLabels(std::shared_ptr<const LabelVoxels> voxels, const IndicatorRules& rules)
      : voxels_(std::move(voxels)), rules_(rules) {}

  std::unique_ptr<LabelSampler> sampler() const override;
  std::unique_ptr<InterfaceProbe> probe() const override;

 private:
  const std::shared_ptr<const LabelVoxels> voxels_;
  const IndicatorRules rules_;
};

}  // namespace tet
