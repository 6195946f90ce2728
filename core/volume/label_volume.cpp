#include "core/volume/label_volume.h"

#include <algorithm>
#include <utility>

#include <absl/status/status.h>
#include <absl/strings/str_format.h>

namespace tet {
namespace {

constexpr std::int32_t kLastInBrick = kBrickEdge - 1;

absl::Status too_many_labels() {
  return absl::FailedPreconditionError(absl::StrFormat(
      "it has more than %d different values, so it is no segmentation: mesh it at an iso value "
      "(--iso)",
      LabelVolume::kMostLabels));
}

BrickCoord brick_of(const VoxelCoord& v) {
  return {v.x >> kBrickShift, v.y >> kBrickShift, v.z >> kBrickShift};
}

bool within(const VoxelBox& box, const VoxelCoord& v) {
  return v.x >= box.min.x && v.x <= box.max.x && v.y >= box.min.y && v.y <= box.max.y &&
         v.z >= box.min.z && v.z <= box.max.z;
}

absl::Status check_size(const LabelImage& image) {
  std::uint64_t voxels = 1;
  for (const std::int32_t edge : image.size) {
    if (edge < 1 || edge > kMaxVoxelCoord) {
      return absl::InvalidArgumentError(
          absl::StrFormat("an edge of %d voxels is outside 1..%d", edge, kMaxVoxelCoord));
    }
    // The product of the first two fits, and is not more than the values are.
    voxels *= static_cast<std::uint64_t>(edge);
    if (voxels > image.values.size()) break;
  }
  if (voxels == image.values.size()) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrFormat("%d x %d x %d voxels do not have %d values",
                                                    image.size[0], image.size[1], image.size[2],
                                                    image.values.size()));
}

}  // namespace

std::size_t LabelVolume::size_bytes() const noexcept {
  return sizeof(*this) + bricks.size() * sizeof(bricks[0]) + values.size() * sizeof(values[0]) +
         labels.size() * (sizeof(labels[0]) + sizeof(voxel_counts[0]));
}

std::uint16_t LabelVolume::at(const VoxelCoord& voxel) const noexcept {
  if (!within(box, voxel)) return kNoLabel;
  const BrickCoord b = brick_of(voxel);
  const auto index = static_cast<std::size_t>(
      (std::int64_t{b.x - first_brick.x} * brick_count[1] + (b.y - first_brick.y)) *
          brick_count[2] +
      (b.z - first_brick.z));
  const std::uint32_t brick = bricks[index];
  if ((brick & kConstant) != 0) return static_cast<std::uint16_t>(brick & ~kConstant);
  const int cell = ((voxel.x & 7) * 8 + (voxel.y & 7)) * 8 + (voxel.z & 7);
  return values[std::size_t{brick} * kBrickCells + static_cast<std::size_t>(cell)];
}

LabelVolumeBuilder::LabelVolumeBuilder(std::string name,
                                       const VoxelTransform& transform,
                                       const VoxelBox& box) {
  volume_.name = std::move(name);
  volume_.transform = transform;
  volume_.box = box;
  volume_.first_brick = brick_of(box.min);
  const BrickCoord last = brick_of(box.max);
  volume_.brick_count = {last.x - volume_.first_brick.x + 1, last.y - volume_.first_brick.y + 1,
                         last.z - volume_.first_brick.z + 1};
}

absl::StatusOr<std::uint16_t> LabelVolumeBuilder::number_of(std::int64_t label) {
  if (last_number_ != kUnset && last_label_ == label) return last_number_;
  const auto at = std::ranges::lower_bound(known_, label, {},
                                           &std::pair<std::int64_t, std::uint16_t>::first);
  if (at != known_.end() && at->first == label) {
    last_number_ = at->second;
  } else {
    if (known_.size() == LabelVolume::kMostLabels) return too_many_labels();
    last_number_ = static_cast<std::uint16_t>(known_.size());
    known_.insert(at, {label, last_number_});
    volume_.voxel_counts.push_back(0);
  }
  last_label_ = label;
  return last_number_;
}

absl::Status LabelVolumeBuilder::add_brick(BrickCoord brick,
                                           std::span<const std::int64_t, kBrickCells> values) {
  const VoxelBox& box = volume_.box;
  const VoxelCoord min{brick.x * kBrickEdge, brick.y * kBrickEdge, brick.z * kBrickEdge};
  const bool whole =
      within(box, min) &&
      within(box, {min.x + kLastInBrick, min.y + kLastInBrick, min.z + kLastInBrick});
  const std::int64_t first = values[0];
  if (whole && std::ranges::all_of(values, [&](std::int64_t v) { return v == first; })) {
    const auto number = number_of(first);
    if (!number.ok()) return number.status();
    volume_.bricks.push_back(LabelVolume::kConstant | *number);
    volume_.voxel_counts[*number] += kBrickCells;
    return absl::OkStatus();
  }
  volume_.bricks.push_back(static_cast<std::uint32_t>(volume_.values.size() / kBrickCells));
  for (int i = 0; i < kBrickCells; ++i) {
    const VoxelCoord voxel{min.x + i / 64, min.y + i / 8 % 8, min.z + i % 8};
    if (!whole && !within(box, voxel)) {
      volume_.values.push_back(LabelVolume::kNoLabel);
      continue;
    }
    const auto number = number_of(values[static_cast<std::size_t>(i)]);
    if (!number.ok()) return number.status();
    volume_.values.push_back(*number);
    ++volume_.voxel_counts[*number];
  }
  return absl::OkStatus();
}

/// Numbers are given as labels come; in the end they are in the labels' order.
LabelVolume LabelVolumeBuilder::build() && {
  std::vector<std::uint16_t> number(known_.size());
  std::vector<std::uint64_t> counts(known_.size());
  for (std::size_t i = 0; i < known_.size(); ++i) {
    number[known_[i].second] = static_cast<std::uint16_t>(i);
    counts[i] = volume_.voxel_counts[known_[i].second];
    volume_.labels.push_back(known_[i].first);
  }
  volume_.voxel_counts = std::move(counts);
  for (std::uint16_t& value : volume_.values) {
    if (value != LabelVolume::kNoLabel) value = number[value];
  }
  for (std::uint32_t& brick : volume_.bricks) {
    if ((brick & LabelVolume::kConstant) == 0) continue;
    brick = LabelVolume::kConstant | number[brick & ~LabelVolume::kConstant];
  }
  return std::move(volume_);
}

absl::StatusOr<LabelVolume> make_label_volume(const LabelImage& image) {
  if (absl::Status s = check_size(image); !s.ok()) return s;
  const auto [nx, ny, nz] = image.size;
  const VoxelCoord min = image.min;
  const VoxelBox box{min, {min.x + nx - 1, min.y + ny - 1, min.z + nz - 1}};
  LabelVolumeBuilder builder(image.name, image.transform, box);
  const BrickCoord first = brick_of(box.min), last = brick_of(box.max);
  std::array<std::int64_t, kBrickCells> values{};
  for (std::int32_t x = first.x; x <= last.x; ++x) {
    for (std::int32_t y = first.y; y <= last.y; ++y) {
      for (std::int32_t z = first.z; z <= last.z; ++z) {
        for (int i = 0; i < kBrickCells; ++i) {
          const VoxelCoord voxel{8 * x + i / 64, 8 * y + i / 8 % 8, 8 * z + i % 8};
          if (!within(box, voxel)) continue;
          const std::int64_t at =
              (std::int64_t{voxel.z - min.z} * ny + (voxel.y - min.y)) * nx + (voxel.x - min.x);
          values[static_cast<std::size_t>(i)] = image.values[static_cast<std::size_t>(at)];
        }
        if (absl::Status s = builder.add_brick({x, y, z}, values); !s.ok()) return s;
      }
    }
  }
  return std::move(builder).build();
}

}  // namespace tet
