#include "core/volume/flat_label_volume.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "core/volume/check_transform.h"
#include "core/volume/grid_info.h"

namespace tet {
namespace {

constexpr std::array<char, 8> kLabelMagic{'t', 'e', 't', '-', 'l', 'a', 'b', '\n'};
constexpr std::uint32_t kLabelVersion = 1;

struct LabelHeader {
  std::array<char, 8> magic = kLabelMagic;
  std::uint32_t version = kLabelVersion;
  std::uint32_t reserved = 0;
  std::uint64_t name_bytes = 0;
  std::uint64_t value_bricks = 0;
  std::uint64_t label_count = 0;
  VoxelBox box;
  VoxelTransform transform;
};
static_assert(sizeof(LabelHeader) == 64 + sizeof(VoxelTransform));

absl::Status wrong_labels(const std::string& what) {
  return absl::InvalidArgumentError(absl::StrCat("the flat labels are not valid: ", what));
}

absl::Status check_box(const VoxelBox& box) {
  const std::array<std::int32_t, 3> min{box.min.x, box.min.y, box.min.z};
  const std::array<std::int32_t, 3> max{box.max.x, box.max.y, box.max.z};
  for (std::size_t i = 0; i < 3; ++i) {
    if (min[i] > max[i] || min[i] < -kMaxVoxelCoord || max[i] > kMaxVoxelCoord) {
      return wrong_labels(absl::StrFormat("its box reaches from %d to %d", min[i], max[i]));
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<LabelHeader> read_label_header(FlatReader& reader) {
  const auto bytes = reader.column<std::byte>(sizeof(LabelHeader));
  if (!bytes) return wrong_labels("it has no header");
  LabelHeader header;
  std::memcpy(&header, bytes->data(), sizeof(LabelHeader));
  if (header.magic != kLabelMagic || header.version != kLabelVersion || header.reserved != 0) {
    return wrong_labels("it does not begin as such a block does");
  }
  if (header.name_bytes > kMaxGridNameBytes) return wrong_labels("its name is too long");
  if (header.label_count == 0 || header.label_count > LabelVolume::kMostLabels) {
    return wrong_labels(absl::StrFormat("it has %d labels", header.label_count));
  }
  if (absl::Status s = check_box(header.box); !s.ok()) return s;
  if (absl::Status s = check_transform(header.transform); !s.ok()) return s;
  return header;
}

std::array<std::int32_t, 3> bricks_along(const VoxelBox& box) {
  const auto along = [](std::int32_t min, std::int32_t max) {
    return (max >> kBrickShift) - (min >> kBrickShift) + 1;
  };
  return {along(box.min.x, box.max.x), along(box.min.y, box.max.y),
          along(box.min.z, box.max.z)};
}

bool is_within(const VoxelBox& box, const VoxelCoord& v) {
  return v.x >= box.min.x && v.x <= box.max.x && v.y >= box.min.y && v.y <= box.max.y &&
         v.z >= box.min.z && v.z <= box.max.z;
}

/// Checks the entries of all bricks, and counts the voxels of each label on the way.
class LabelCounter {
 public:
  explicit LabelCounter(LabelVolume& volume) : volume_(volume) {
    volume_.voxel_counts.assign(volume_.labels.size(), 0);
  }

  absl::Status count(const Cancellation& cancellation) {
    std::uint32_t next = 0;
    std::size_t at = 0;
    const auto [nx, ny, nz] = volume_.brick_count;
    for (std::int32_t x = 0; x < nx; ++x) {
      for (std::int32_t y = 0; y < ny; ++y) {
        for (std::int32_t z = 0; z < nz; ++z) {
          if (at % kBetweenLooks == 0) {
            if (absl::Status s = check_cancelled(cancellation); !s.ok()) return s;
          }
          const BrickCoord& first = volume_.first_brick;
          const VoxelCoord min{8 * (first.x + x), 8 * (first.y + y), 8 * (first.z + z)};
          const std::uint32_t entry = volume_.bricks[at++];
          if ((entry & LabelVolume::kConstant) == 0 && entry != next++) {
            return wrong_labels("its bricks are not in order");
          }
          if (absl::Status s = count_brick(entry, min); !s.ok()) return s;
        }
      }
    }
    const bool all = std::size_t{next} * kBrickCells == volume_.values.size();
    return all ? absl::OkStatus() : wrong_labels("it has values of no brick");
  }

 private:
  static constexpr std::size_t kBetweenLooks = 1024;  ///< bricks: some milliseconds

  absl::Status count_brick(std::uint32_t entry, const VoxelCoord& min) {
    const VoxelBox& box = volume_.box;
    if ((entry & LabelVolume::kConstant) != 0) {
      const std::uint32_t label = entry & ~LabelVolume::kConstant;
      const bool whole =
          is_within(box, min) && is_within(box, {min.x + 7, min.y + 7, min.z + 7});
      if (label >= volume_.labels.size() || !whole) return wrong_labels("a brick has no label");
      volume_.voxel_counts[label] += kBrickCells;
      return absl::OkStatus();
    }
    const std::size_t from = std::size_t{entry} * kBrickCells;
    if (from + kBrickCells > volume_.values.size())
      return wrong_labels("a brick has no values");
    for (int i = 0; i < kBrickCells; ++i) {
      const std::uint16_t label = volume_.values[from + static_cast<std::size_t>(i)];
      const VoxelCoord voxel{min.x + i / 64, min.y + i / 8 % 8, min.z + i % 8};
      const bool within = is_within(box, voxel);
      if (within ? label >= volume_.labels.size() : label != LabelVolume::kNoLabel) {
        return wrong_labels("a voxel has no label");
      }
      if (within) ++volume_.voxel_counts[label];
    }
    return absl::OkStatus();
  }

  LabelVolume& volume_;
};

}  // namespace

std::uint64_t flat_label_bytes(const LabelVolume& volume) {
  return column_bytes(sizeof(LabelHeader)) + column_bytes(volume.name.size()) +
         column_bytes(volume.bricks.size() * sizeof(std::uint32_t)) +
         column_bytes(volume.values.size() * sizeof(std::uint16_t)) +
         column_bytes(volume.labels.size() * sizeof(std::int64_t));
}

absl::Status write_flat_labels(const LabelVolume& volume, const ByteSink& sink) {
  LabelHeader header;
  header.name_bytes = volume.name.size();
  header.value_bricks = volume.values.size() / kBrickCells;
  header.label_count = volume.labels.size();
  header.box = volume.box;
  header.transform = volume.transform;
  FlatWriter writer(sink);
  writer.add(std::span<const LabelHeader>(&header, 1));
  writer.add(std::span<const char>(volume.name));
  writer.add(std::span<const std::uint32_t>(volume.bricks));
  writer.add(std::span<const std::uint16_t>(volume.values));
  writer.add(std::span<const std::int64_t>(volume.labels));
  return writer.status();
}

absl::StatusOr<LabelVolume> read_flat_labels(std::span<const std::byte> block,
                                             std::uint64_t max_bytes,
                                             const Cancellation& cancellation) {
  FlatReader reader(block);
  const absl::StatusOr<LabelHeader> header = read_label_header(reader);
  if (!header.ok()) return header.status();
  LabelVolume volume;
  volume.transform = header->transform;
  volume.box = header->box;
  volume.first_brick = {header->box.min.x >> kBrickShift, header->box.min.y >> kBrickShift,
                        header->box.min.z >> kBrickShift};
  volume.brick_count = bricks_along(header->box);
  const auto [nx, ny, nz] = volume.brick_count;
  // Each is below 2^28, and a block of bytes below 2^60.
  const std::uint64_t slice = static_cast<std::uint64_t>(nx) * static_cast<std::uint64_t>(ny);
  const auto name = reader.column<char>(header->name_bytes);
  const auto bricks = name && slice <= block.size()
                          ? reader.column<std::uint32_t>(slice, static_cast<std::uint64_t>(nz))
                          : std::nullopt;
  if (!bricks) return wrong_labels("its bricks do not fit in it");
  const auto values = reader.column<std::uint16_t>(header->value_bricks, kBrickCells);
  if (!values) return wrong_labels("its values do not fit in it");
  const auto labels = reader.column<std::int64_t>(header->label_count);
  if (!labels || !reader.at_end()) return wrong_labels("its labels do not fill it");
  if (std::ranges::adjacent_find(*labels, std::greater_equal<>()) != labels->end()) {
    return wrong_labels("its labels are not in order");
  }
  if (block.size() > max_bytes) {
    return absl::ResourceExhaustedError(absl::StrFormat(
        "its labels take %d bytes and the limit is %d", block.size(), max_bytes));
  }
  volume.name.assign(name->begin(), name->end());
  copy_column(*bricks, cancellation, volume.bricks);
  copy_column(*values, cancellation, volume.values);
  copy_column(*labels, cancellation, volume.labels);
  if (absl::Status s = check_cancelled(cancellation); !s.ok()) return s;
  if (absl::Status s = LabelCounter(volume).count(cancellation); !s.ok()) return s;
  return volume;
}

}  // namespace tet
