// The voxels of a segmentation as labels of a mesh.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "core/labels/indicators.h"
#include "core/volume/label_volume.h"

namespace tet {

/// Labels of a volume, each as `label_of` its number; beyond the image, and where a number has
/// none, there is `beyond`.
class VolumeLabels final : public LabelVoxels {
 public:
  VolumeLabels(std::shared_ptr<const LabelVolume> volume,
               std::vector<Label> label_of,
               Label beyond);

  std::optional<Label> one_label(const VoxelBox& box) const override;
  void copy(const VoxelBox& box, Label* out) const override;

  Label at(const VoxelCoord& voxel) const noexcept { return label(volume_->at(voxel)); }

 private:
  Label label(std::uint16_t number) const noexcept {
    return number < label_of_.size() ? label_of_[number] : beyond_;
  }
  template <std::size_t kCount>
  void copy_numbers(const std::uint16_t* value, std::size_t count, Label* out) const noexcept;
  void copy_brick(const BrickCoord& b, const VoxelBox& box, Label* out) const;
  Label label_of_brick(std::uint32_t constant) const noexcept {
    return label(static_cast<std::uint16_t>(constant & ~LabelVolume::kConstant));
  }

  const std::shared_ptr<const LabelVolume> volume_;
  const std::vector<Label> label_of_;
  const Label beyond_;
  bool are_numbers_ = true;  ///< each label is the number that the volume has for it
};

/// Labels on voxels of another shape: each has the label of the voxel that its centre lies in.
/// For sheared voxels, on which no cubic lattice lies.
class ResampledLabels final : public LabelVoxels {
 public:
  /// voxel of `labels` = linear * voxel + shift.
  struct Map {
    std::array<std::array<double, 3>, 3> linear;
    std::array<double, 3> shift;
  };
  ResampledLabels(std::shared_ptr<const VolumeLabels> labels, const Map& map)
      : labels_(std::move(labels)), map_(map) {}

  std::optional<Label> one_label(const VoxelBox& box) const override;
  void copy(const VoxelBox& box, Label* out) const override;

 private:
  VoxelCoord voxel_at(const VoxelCoord& voxel) const noexcept;

  const std::shared_ptr<const VolumeLabels> labels_;
  const Map map_;
};

}  // namespace tet
