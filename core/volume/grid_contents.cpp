#include "core/volume/grid_contents.h"

#include <algorithm>

#include "core/volume/inside.h"

namespace tet {
namespace {

void add(const VoxelBox& more, VoxelBox& box) noexcept {
  box.min = {std::min(box.min.x, more.min.x), std::min(box.min.y, more.min.y),
             std::min(box.min.z, more.min.z)};
  box.max = {std::max(box.max.x, more.max.x), std::max(box.max.y, more.max.y),
             std::max(box.max.z, more.max.z)};
}

/// The voxels of a brick that the image has.
VoxelBox part_of(const VoxelBox& image, const BrickCoord& brick) noexcept {
  const auto low = [](std::int32_t at, std::int32_t min) {
    return std::max(at * kBrickEdge, min);
  };
  const auto high = [](std::int32_t at, std::int32_t max) {
    return std::min(at * kBrickEdge + kBrickEdge - 1, max);
  };
  return {{low(brick.x, image.min.x), low(brick.y, image.min.y), low(brick.z, image.min.z)},
          {high(brick.x, image.max.x), high(brick.y, image.max.y), high(brick.z, image.max.z)}};
}

/// Adds each voxel of a brick's `part` to the box of its label. values: one per voxel.
void add_voxels(const VoxelBox& part,
                const std::uint16_t* values,
                std::vector<VoxelBox>& boxes) noexcept {
  for (std::int32_t x = part.min.x; x <= part.max.x; ++x) {
    for (std::int32_t y = part.min.y; y <= part.max.y; ++y) {
      for (std::int32_t z = part.min.z; z <= part.max.z; ++z) {
        const VoxelCoord at{x, y, z};
        add({at, at}, boxes[values[(x & 7) * 64 + (y & 7) * 8 + (z & 7)]]);
      }
    }
  }
}

/// Boxes around the voxels of each label, by number.
std::vector<VoxelBox> boxes_of(const LabelVolume& volume) {
  constexpr VoxelBox kNone{{INT32_MAX, INT32_MAX, INT32_MAX},
                           {INT32_MIN, INT32_MIN, INT32_MIN}};
  std::vector<VoxelBox> boxes(volume.labels.size(), kNone);
  const auto [nx, ny, nz] = volume.brick_count;
  std::size_t next = 0;
  for (std::int32_t x = 0; x < nx; ++x) {
    for (std::int32_t y = 0; y < ny; ++y) {
      for (std::int32_t z = 0; z < nz; ++z) {
        const BrickCoord& first = volume.first_brick;
        const VoxelBox part = part_of(volume.box, {first.x + x, first.y + y, first.z + z});
        const std::uint32_t brick = volume.bricks[next++];
        if ((brick & LabelVolume::kConstant) != 0) {
          add(part, boxes[brick & ~LabelVolume::kConstant]);
          continue;
        }
        const std::uint16_t* const values =
            volume.values.data() + std::size_t{brick} * kBrickCells;
        add_voxels(part, values, boxes);
      }
    }
  }
  return boxes;
}

}  // namespace

GridValues values_of(const Volume& volume) noexcept {
  return {value_range(volume), volume.background, own_side(volume), volume.kind_source};
}

bool may_have_labels(const GridInfo& grid) {
  const std::string& type = grid.value_type;
  const bool is_whole =
      type.find("int") != std::string::npos || type == "bool" || type == "mask";
  return is_whole && grid.not_meshable.empty();
}

void set_labels_of(const LabelVolume& volume, GridContents& contents) {
  const std::vector<VoxelBox> boxes = boxes_of(volume);
  contents.label_count = volume.labels.size();
  contents.labels.clear();
  for (std::size_t i = 0; i < std::min(boxes.size(), kMostListedLabels); ++i) {
    contents.labels.push_back({volume.labels[i], volume.voxel_counts[i], boxes[i]});
  }
}

}  // namespace tet
