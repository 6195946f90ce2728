// Which maps from voxels to the world can be meshed.
#pragma once

#include <array>

#include <absl/status/status.h>

#include "core/volume/volume.h"

namespace tet {

/// The edges of a voxel, world units.
std::array<double, 3> voxel_edges(const VoxelTransform& transform) noexcept;

/// Whether the edges meet at right angles, up to what float32 matrices are off by.
bool are_square(const VoxelTransform& transform) noexcept;

/// Whether voxels are cubes, up to that. The lattice of a mesh then lies on the voxels, and
/// `linear` is a scaled rotation, whose inverse is its transpose, scaled; else the lattice is
/// one of the world.
bool has_cubic_voxels(const VoxelTransform& transform) noexcept;

/// The edge of a cubic voxel, and the shortest one of another: `voxel_size` of a map that has
/// this `linear`. Not finite for a map beyond double's range.
double voxel_edge(const VoxelTransform& transform) noexcept;

/// Ok when the map is finite, its voxels are no flatter and no longer than can be meshed, and
/// `voxel_size` is their voxel_edge. Errors: kFailedPrecondition (says what to do).
absl::Status check_transform(const VoxelTransform& transform);

}  // namespace tet
