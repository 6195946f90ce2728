// A segmentation as the mesher reads it: what each voxel of an image is a part of.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <absl/status/statusor.h>

#include "core/base/types.h"
#include "core/volume/volume.h"

namespace tet {

/// Labels of all voxels of a box, in bricks of 8 x 8 x 8; beyond the box there is none.
///
/// A voxel holds the number of its label in `labels`, not the label: files use any integers,
/// and an atlas those of nine digits. Immutable once built, so any number of threads may read
/// it.
struct LabelVolume {
  /// Marks an entry of `bricks`: its brick holds one label throughout, whose number the other
  /// bits are.
  static constexpr std::uint32_t kConstant = std::uint32_t{1} << 31;
  static constexpr std::size_t kMostLabels = 65535;
  /// What a voxel beyond the image has, where the image has all other numbers.
  static constexpr std::uint16_t kNoLabel = 65535;

  std::string name;
  VoxelTransform transform;
  VoxelBox box;                               ///< voxels that the image has; not empty
  BrickCoord first_brick;                     ///< the one that box.min lies in
  std::array<std::int32_t, 3> brick_count{};  ///< bricks that the box reaches into

  std::vector<std::uint32_t> bricks;  ///< at (x*ny + y)*nz + z from first_brick on
  std::vector<std::uint16_t> values;  ///< 512 a brick that is not constant, in their order
  std::vector<std::int64_t> labels;   ///< sorted, unique
  std::vector<std::uint64_t> voxel_counts;  ///< of each label

  std::size_t size_bytes() const noexcept;

  /// The number of a voxel's label; kNoLabel beyond the image.
  std::uint16_t at(const VoxelCoord& voxel) const noexcept;
};

/// Integers of an image, x fastest, then y, then z, from the lowest voxel of its box on.
struct LabelImage {
  std::string name;
  VoxelTransform transform;
  std::array<std::int32_t, 3> size{};
  VoxelCoord min;
  std::span<const std::int64_t> values = {};
};

/// Errors: kInvalidArgument (sizes and values do not agree), kFailedPrecondition (more labels
/// than kMostLabels: it is no segmentation; says what to do).
absl::StatusOr<LabelVolume> make_label_volume(const LabelImage& image);

/// Gathers a segmentation brick by brick, so that no image of 64-bit numbers is needed.
///
/// Not thread-safe.
class LabelVolumeBuilder {
 public:
  LabelVolumeBuilder(std::string name, const VoxelTransform& transform, const VoxelBox& box);

  /// `values` at (x*8 + y)*8 + z, of the brick at `brick`; those beyond the box count for
  /// nothing. A brick comes once, and all of the box's do, in the order of `bricks`.
  absl::Status add_brick(BrickCoord brick, std::span<const std::int64_t, kBrickCells> values);

  LabelVolume build() &&;

 private:
  absl::StatusOr<std::uint16_t> number_of(std::int64_t label);

  LabelVolume volume_;
  std::vector<std::pair<std::int64_t, std::uint16_t>> known_;  // sorted by label
  std::int64_t last_label_ = 0;
  std::uint16_t last_number_ = kUnset;
  static constexpr std::uint16_t kUnset = LabelVolume::kNoLabel;
};

}  // namespace tet
