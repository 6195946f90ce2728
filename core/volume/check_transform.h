// Which maps from voxels to the world can be meshed.
#pragma once

#include <array>
#include <string_view>

#include <absl/status/status.h>

#include "core/volume/volume.h"

namespace tet {

/// What an edge of a voxel, or a lattice's spacing, may be, world units. The positions of a
/// mesh, up to 2^30 of the longest away from its origin, are float32 numbers, and the eighth
/// power of the shortest, by which shapes of tets are measured, is no zero in double.
inline constexpr double kShortestEdge = 1e-28, kLongestEdge = 1e28;

/// Not of what is no number.
constexpr bool may_be_edge(double length) noexcept {
  return length >= kShortestEdge && length <= kLongestEdge;
}

/// Ok where `length`, which messages call `what`, may be an edge; else kInvalidArgument (says
/// what to do).
absl::Status check_edge(std::string_view what, double length);

/// The edges of a voxel, world units.
std::array<double, 3> voxel_edges(const VoxelTransform& transform) noexcept;

/// Whether the edges meet at right angles, up to what float32 matrices are off by.
bool are_square(const VoxelTransform& transform) noexcept;

/// Whether voxels are cubes, up to that. The lattice of a mesh then lies on the voxels; else it
/// is one of the world.
bool has_cubic_voxels(const VoxelTransform& transform) noexcept;

/// Whether `linear` is `voxel_size` times a rotation, or a mirrored one, up to what doubles
/// are off by: its inverse is its transpose then, scaled.
bool is_scaled_rotation(const VoxelTransform& transform) noexcept;

/// The edge of a cubic voxel, and the shortest one of another: `voxel_size` of a map that has
/// this `linear`. Not finite for a map beyond double's range.
double voxel_edge(const VoxelTransform& transform) noexcept;

/// Ok when the map is finite, its voxels are no flatter and no longer than can be meshed, and
/// `voxel_size` is their voxel_edge. Errors: kFailedPrecondition (says what to do).
absl::Status check_transform(const VoxelTransform& transform);

}  // namespace tet
