// Copies of the voxels of boxes, where many points lie together.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/types.h"
#include "core/volume/volume_reader.h"

namespace tet {

/// Copying a voxel takes about a sixteenth of looking up the eight around a point.
inline constexpr std::int64_t kVoxelsPerPoint = 16;

/// How many voxels a box has; far too many for any block where edges are a million and more.
std::int64_t voxels_in(const VoxelBox& box) noexcept;

/// Whether all voxels of one box are in another.
bool contains(const VoxelBox& outer, const VoxelBox& inner) noexcept;

/// The box of the eight voxels of each of the cells, of which there is one or more.
VoxelBox box_of_cells(const std::int32_t* x,
                      const std::int32_t* y,
                      const std::int32_t* z,
                      std::size_t count) noexcept;

/// Copies the voxels of a box, with those of z next to each other, then those of y.
void copy_voxels(VolumeReader& reader, const VoxelBox& box, float* values) noexcept;

/// The voxels of a box, as copy_voxels copies them.
struct VoxelBlock {
  static constexpr std::int64_t kMaxVoxels = 1 << 12;
  VoxelBox box;
  std::array<float, kMaxVoxels> values;

  /// Copies those of another box, which has kMaxVoxels at most.
  void copy(VolumeReader& reader, const VoxelBox& from) noexcept;
};

/// VolumeReader::trilinear, to the last bit, at points between the voxels of a block.
void interpolate_in(const VoxelBlock& block,
                    const double* x,
                    const double* y,
                    const double* z,
                    std::size_t count,
                    double* values) noexcept;

}  // namespace tet
