// A grid as a scene: how one is meshed whose voxels are no cubes.
#pragma once

#include <memory>

#include "core/scene/scene.h"
#include "core/volume/inside.h"

namespace tet {

/// phi = sign * (value - iso) of one grid, by trilinear interpolation between its voxels
/// wherever these lie in the world. The scene's extent is infinite where the background is
/// inside, and empty where nothing is. Reads the whole grid; parallel.
Scene scene_of_grid(const std::shared_ptr<const Volume>& volume, float iso, InsideSide inside);

}  // namespace tet
