// Copies of the voxels of boxes, where many points lie together.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/base/types.h"
#include "core/volume/volume_reader.h"

namespace tet {

/// Copying a voxel takes about a sixteenth of looking up the eight around a point.
inline constexpr std::int64_t kVoxelsPerPoint = 16;

/// How many voxels a box has; far too many for any block where edges are a million and more.
std::int64_t voxels_in(const VoxelBox& box) noexcept;

/// The box of the eight voxels of each of the cells, of which there is one or more.
VoxelBox box_of_cells(const std::int32_t* x,
                      const std::int32_t* y,
                      const std::int32_t* z,
                      std::size_t count) noexcept;

/// Copies the voxels of a box, with those of z next to each other, then those of y.
void copy_voxels(VolumeReader& reader, const VoxelBox& box, float* values) noexcept;

}  // namespace tet
