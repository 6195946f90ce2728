// Labels of voxels in plain arrays.
#pragma once

#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "core/labels/indicators.h"

namespace tet::test {

/// Voxels [0, edge)^3 with the labels of a function, and one label beyond them.
class VoxelArray final : public LabelVoxels {
 public:
  VoxelArray(std::int32_t edge, Label beyond, const std::function<Label(VoxelCoord)>& label)
      : edge_(edge), beyond_(beyond) {
    for (std::int32_t x = 0; x < edge; ++x) {
      for (std::int32_t y = 0; y < edge; ++y) {
        for (std::int32_t z = 0; z < edge; ++z) label_.push_back(label({x, y, z}));
      }
    }
  }

  Label at(VoxelCoord v) const noexcept {
    const auto within = [&](std::int32_t i) { return i >= 0 && i < edge_; };
    if (!within(v.x) || !within(v.y) || !within(v.z)) return beyond_;
    return label_[static_cast<std::size_t>((v.x * edge_ + v.y) * edge_ + v.z)];
  }

  std::optional<Label> one_label(const VoxelBox&) const override { return std::nullopt; }

  void copy(const VoxelBox& box, Label* out) const override {
    for (std::int32_t x = box.min.x; x <= box.max.x; ++x) {
      for (std::int32_t y = box.min.y; y <= box.max.y; ++y) {
        for (std::int32_t z = box.min.z; z <= box.max.z; ++z) *out++ = at({x, y, z});
      }
    }
  }

 private:
  std::int32_t edge_;
  Label beyond_;
  std::vector<Label> label_;
};

}  // namespace tet::test
