#include "core/image/image_outline.h"

#include <algorithm>

#include "core/base/types.h"

namespace tet {
namespace {

/// What a volume takes by the voxel: a brick's values, place and range, and the regions around.
constexpr std::uint64_t kVolumeBytesPerVoxel = 5;
constexpr std::uint64_t kVolumeBytesAtLeast = std::uint64_t{4} << 20;

/// Voxels of the bricks that an image reaches into: a thin one fills few of their slices.
std::uint64_t voxels_in_bricks(const ImageArray& array) {
  std::uint64_t voxels = 1;
  for (const std::int32_t edge : array.size) {
    voxels *= (static_cast<std::uint64_t>(edge) + kBrickEdge - 1) / kBrickEdge * kBrickEdge;
  }
  return voxels;
}

/// Voxels of the bricks of an image of so many, when nothing is known of its shape: one slice
/// has an eighth of its bricks, as long as slices are no larger than any scanner's.
std::uint64_t most_voxels_in_bricks(std::uint64_t voxels) {
  constexpr std::uint64_t kLargestSlice = 4096 * 4096;
  return voxels + (kBrickEdge - 1) * std::min(voxels, kLargestSlice + kLargestSlice / 64);
}

}  // namespace

const char* scalar_name(ScalarType type) noexcept {
  constexpr std::array<const char*, 10> kNames{"int8",    "uint8",  "int16", "uint16",
                                               "int32",   "uint32", "int64", "uint64",
                                               "float32", "float64"};
  return kNames[static_cast<std::size_t>(type)];
}

const char* format_name(ImageFormat format) noexcept {
  constexpr std::array<const char*, 5> kNames{"NIfTI", "NRRD", "MetaImage", "VTK image",
                                              "NumPy"};
  return kNames[static_cast<std::size_t>(format)];
}

std::uint64_t ImageOutline::volume_bytes() const noexcept {
  std::uint64_t voxels = packed ? unpacked_bytes : 0;
  for (const ImageArray& array : arrays) voxels = std::max(voxels, voxels_in_bricks(array));
  return kVolumeBytesAtLeast + kVolumeBytesPerVoxel * voxels;
}

std::uint64_t ImageOutline::reading_bytes(std::uint64_t file_bytes) const noexcept {
  std::uint64_t values = packed ? unpacked_bytes : 0;
  for (const ImageArray& array : arrays) values = std::max(values, array.value_bytes());
  // Text between tags is read as a whole.
  const std::uint64_t text = format == ImageFormat::kVti ? 2 * file_bytes : 0;
  return volume_bytes() + 2 * values + text;
}

std::uint64_t ImageOutline::most_unpacked_bytes(std::uint64_t file_bytes) const noexcept {
  constexpr std::uint64_t kLikelyExpansion = 64;  // of images, and more than most have
  // What is claimed may be the last member's length alone, or less by 4 GiB and more.
  return packed ? std::max(kLikelyExpansion * file_bytes, unpacked_bytes) : 0;
}

std::uint64_t ImageOutline::most_volume_bytes(std::uint64_t file_bytes) const noexcept {
  if (!packed) return volume_bytes();
  const std::uint64_t voxels = most_voxels_in_bricks(most_unpacked_bytes(file_bytes));
  return kVolumeBytesAtLeast + kVolumeBytesPerVoxel * voxels;
}

std::uint64_t ImageOutline::most_reading_bytes(std::uint64_t file_bytes) const noexcept {
  if (!packed) return reading_bytes(file_bytes);
  return most_volume_bytes(file_bytes) + 2 * most_unpacked_bytes(file_bytes);
}

}  // namespace tet
