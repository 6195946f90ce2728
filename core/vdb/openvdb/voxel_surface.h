// A surface in the voxels of the grid that it becomes.
#pragma once

#include <array>

#include <absl/status/statusor.h>

#include "core/surface/triangle_surface.h"

namespace tet {

/// Vertices in voxels, so that sizes and places of the world play no part in what follows:
/// world = voxel_size * vertex + translation.
struct VoxelSurface {
  TriangleSurface surface;
  double voxel_size = 1;
  WorldPoint translation;  ///< zero unless the surface is far from the world's origin
};

/// Errors: kInvalidArgument (voxel size not positive, or one whose distances no float holds; no
/// triangle), kResourceExhausted (so small that the band would not fit; says the value and the
/// limit).
absl::StatusOr<VoxelSurface> to_voxels(const TriangleSurface& surface, double voxel_size);

/// Voxels to either side of the surface that have values.
inline constexpr double kHalfBand = 3;

}  // namespace tet
