#include "core/plan/labelled/volume_labels.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "core/base/brick_box.h"

namespace tet {
namespace {

/// What lies along one axis of a volume of 32-bit coordinates, and a little beyond.
std::int32_t clamped_voxel(double v) noexcept {
  constexpr double kMost = 2.0 * kMaxVoxelCoord;
  return static_cast<std::int32_t>(std::clamp(v, -kMost, kMost));
}

/// Where a brick's entry lies among a volume's; nothing where the image has no such brick.
std::optional<std::uint32_t> brick_of_labels(const LabelVolume& volume,
                                             const BrickCoord& b) noexcept {
  const std::int64_t x = std::int64_t{b.x} - volume.first_brick.x,
                     y = std::int64_t{b.y} - volume.first_brick.y,
                     z = std::int64_t{b.z} - volume.first_brick.z;
  const auto& [nx, ny, nz] = volume.brick_count;
  if (x < 0 || y < 0 || z < 0 || x >= nx || y >= ny || z >= nz) return std::nullopt;
  return volume.bricks[static_cast<std::size_t>((x * ny + y) * nz + z)];
}

/// The bricks of an image that a run of voxels passes along one axis.
struct AxisBricks {
  std::int32_t first, last;
  bool leaves;  ///< the run has voxels beyond them

  AxisBricks(std::int32_t min, std::int32_t max, std::int32_t first_brick, std::int32_t bricks)
      : first(std::max(min >> kBrickShift, first_brick)),
        last(std::min(max >> kBrickShift, first_brick + bricks - 1)),
        leaves(first > min >> kBrickShift || last < max >> kBrickShift) {}
  std::int64_t count() const noexcept {
    return std::max<std::int64_t>(0, std::int64_t{last} - first + 1);
  }
};

}  // namespace

VolumeLabels::VolumeLabels(std::shared_ptr<const LabelVolume> volume,
                           std::vector<Label> label_of,
                           Label beyond)
    : volume_(std::move(volume)), label_of_(std::move(label_of)), beyond_(beyond) {
  for (std::size_t n = 0; n < label_of_.size(); ++n) are_numbers_ &= label_of_[n] == n;
}

std::optional<Label> VolumeLabels::one_label(const VoxelBox& box) const {
  constexpr std::int64_t kMostBricks = 4096;  // of what is told at small cost
  const AxisBricks x(box.min.x, box.max.x, volume_->first_brick.x, volume_->brick_count[0]),
      y(box.min.y, box.max.y, volume_->first_brick.y, volume_->brick_count[1]),
      z(box.min.z, box.max.z, volume_->first_brick.z, volume_->brick_count[2]);
  if (x.count() == 0 || y.count() == 0 || z.count() == 0) return beyond_;
  if (x.count() > kMostBricks / y.count() / z.count()) return std::nullopt;
  std::optional<Label> one;
  if (x.leaves || y.leaves || z.leaves) one = beyond_;
  for (std::int32_t i = x.first; i <= x.last; ++i) {
    for (std::int32_t j = y.first; j <= y.last; ++j) {
      for (std::int32_t k = z.first; k <= z.last; ++k) {
        const auto found = brick_of_labels(*volume_, {i, j, k});
        if (!found || (*found & LabelVolume::kConstant) == 0) return std::nullopt;
        const Label here = label_of_brick(*found);
        if (one && *one != here) return std::nullopt;
        one = here;
      }
    }
  }
  return one;
}

/// Copies a row of labels that are the numbers of the volume: kCount of them, or for 0 any
/// count.
template <std::size_t kCount>
void VolumeLabels::copy_numbers(const std::uint16_t* value,
                                std::size_t count,
                                Label* out) const noexcept {
  const std::size_t labels = label_of_.size(), all = kCount != 0 ? kCount : count;
  const Label beyond = beyond_;
  for (std::size_t i = 0; i < all; ++i) out[i] = value[i] < labels ? value[i] : beyond;
}

/// Copies the part of a box that lies in one of the volume's bricks, whether there is one or
/// not. `out` is for all of the box.
void VolumeLabels::copy_brick(const BrickCoord& b, const VoxelBox& box, Label* out) const {
  const auto from = [](std::int32_t brick, std::int32_t min) {
    return std::max(brick * kBrickEdge, min);
  };
  const auto end = [](std::int32_t brick, std::int32_t max) {
    return std::min(brick * kBrickEdge + kBrickEdge - 1, max) + 1;
  };
  const std::size_t ny = static_cast<std::size_t>(box.max.y - box.min.y + 1),
                    nz = static_cast<std::size_t>(box.max.z - box.min.z + 1);
  const std::int32_t first_z = from(b.z, box.min.z);
  const auto count = static_cast<std::size_t>(end(b.z, box.max.z) - first_z);
  const auto found = brick_of_labels(*volume_, b);
  const bool constant = !found || (*found & LabelVolume::kConstant) != 0;
  const Label one = found && constant ? label_of_brick(*found) : beyond_;
  for (std::int32_t x = from(b.x, box.min.x); x < end(b.x, box.max.x); ++x) {
    for (std::int32_t y = from(b.y, box.min.y); y < end(b.y, box.max.y); ++y) {
      Label* const row = out +
                         (static_cast<std::size_t>(x - box.min.x) * ny +
                          static_cast<std::size_t>(y - box.min.y)) *
                             nz +
                         static_cast<std::size_t>(first_z - box.min.z);
      if (constant) {
        std::fill_n(row, count, one);
        continue;
      }
      const std::uint16_t* const value =
          volume_->values.data() + std::size_t{*found} * kBrickCells +
          static_cast<std::size_t>((x & 7) * 64 + (y & 7) * 8 + (first_z & 7));
      if (!are_numbers_) {
        for (std::size_t i = 0; i < count; ++i) row[i] = label(value[i]);
      } else if (count == kBrickEdge) {
        copy_numbers<kBrickEdge>(value, count, row);
      } else {
        copy_numbers<0>(value, count, row);
      }
    }
  }
}

void VolumeLabels::copy(const VoxelBox& box, Label* out) const {
  const auto brick = [](std::int32_t voxel) { return voxel >> kBrickShift; };
  for_each_brick({{brick(box.min.x), brick(box.min.y), brick(box.min.z)},
                  {brick(box.max.x), brick(box.max.y), brick(box.max.z)}},
                 [&](const BrickCoord& b) { copy_brick(b, box, out); });
}

VoxelCoord ResampledLabels::voxel_at(const VoxelCoord& voxel) const noexcept {
  const auto along = [&](std::size_t axis) {
    const auto& row = map_.linear[axis];
    return clamped_voxel(std::floor(row[0] * voxel.x + row[1] * voxel.y + row[2] * voxel.z +
                                    map_.shift[axis] + 0.5));
  };
  return {along(0), along(1), along(2)};
}

std::optional<Label> ResampledLabels::one_label(const VoxelBox& box) const {
  VoxelBox around{{INT32_MAX, INT32_MAX, INT32_MAX}, {INT32_MIN, INT32_MIN, INT32_MIN}};
  for (int corner = 0; corner < 8; ++corner) {
    const VoxelCoord v = voxel_at({(corner & 1) != 0 ? box.max.x : box.min.x,
                                   (corner & 2) != 0 ? box.max.y : box.min.y,
                                   (corner & 4) != 0 ? box.max.z : box.min.z});
    // One more, for what rounding does between the corners.
    around.min = {std::min(around.min.x, v.x - 1), std::min(around.min.y, v.y - 1),
                  std::min(around.min.z, v.z - 1)};
    around.max = {std::max(around.max.x, v.x + 1), std::max(around.max.y, v.y + 1),
                  std::max(around.max.z, v.z + 1)};
  }
  return labels_->one_label(around);
}

void ResampledLabels::copy(const VoxelBox& box, Label* out) const {
  for (std::int32_t x = box.min.x; x <= box.max.x; ++x) {
    for (std::int32_t y = box.min.y; y <= box.max.y; ++y) {
      for (std::int32_t z = box.min.z; z <= box.max.z; ++z) {
        *out++ = labels_->at(voxel_at({x, y, z}));
      }
    }
  }
}

}  // namespace tet
