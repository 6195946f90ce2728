// Grids to be leaves of scenes.
#pragma once

#include <cstdint>
#include <memory>

#include "core/base/types.h"
#include "core/scene/scene_nodes.h"
#include "core/volume/volume.h"

namespace tet::test {

/// A narrow-band level set of a ball: `band` voxels on either side. The grid is turned about
/// the axis (1, 1, 1) by a third of a turn where it is `turned`, and moved by half a voxel
/// where it is `shifted`.
struct BallGrid {
  double radius = 1, voxel = 0.1, band = 3;
  bool turned = false, shifted = false;
  WorldPoint centre = {};
};
std::shared_ptr<const Volume> grid_of(const BallGrid& ball);

/// A fog volume: 1 within the ball, 0 beyond, and falling in between over `band` voxels.
std::shared_ptr<const Volume> fog_of(const BallGrid& ball);

/// Any values in any voxel of a cube about the origin, outside beyond: nothing is a distance.
std::shared_ptr<const Volume> random_grid(std::uint32_t seed);

/// A loaded leaf.
scene::GridSolid leaf(std::shared_ptr<const Volume> volume);

}  // namespace tet::test
