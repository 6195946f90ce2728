// Solids and fields that the mesher's tests mesh, as volumes made without OpenVDB.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/volume/volume.h"

namespace tet::test {

/// A solid whose boundary is known.
struct Solid {
  std::string name;
  Volume volume;
  std::uint64_t components = 0;           ///< of the boundary
  std::int64_t euler_characteristic = 0;  ///< of the whole boundary
  double enclosed_volume = 0;             ///< world units cubed
};

/// Radius in voxels; the centre is off the lattice on purpose.
Volume ball(double radius, const VoxelTransform& transform = {});

/// Ball, torus, two balls, ball with a cavity: resolved, smooth, with known topology. For a
/// sanitizer, the first and the last.
std::vector<Solid> smooth_solids();

/// A round plate with a rounded rim, tilted so that its normal is `normal` (of any length).
struct Plate {
  double thickness = 1, radius = 11;  ///< of the flat part, voxels
  WorldPoint normal{0.36, 0.48, 0.8};
};
Volume plate(const Plate& plate, const VoxelTransform& transform = {});

/// A ball of `radius` voxels with a spherical gap `gap` voxels wide halfway to its centre.
Volume ball_with_gap(double radius, double gap);

/// A cube of `edge` voxels, tilted.
Volume tilted_cube(double edge);

/// A gyroid sheet of `edge` voxels cut by a ball.
Volume gyroid_ball(int edge);

/// An independent random value at every voxel: the harshest input there is. One value in
/// `zero_every` is exactly zero; 0 for none.
Volume random_signs(int edge, std::uint32_t seed, int zero_every = 0);

/// A ball with some of its constant inside bricks turned outside: surfaces between constants,
/// where no brick has values of its own.
Volume ball_with_flipped_tiles(double radius);

/// A fog volume: density 1 inside a ball, falling to 0 over a few voxels.
Volume fog_ball(double radius);

}  // namespace tet::test
