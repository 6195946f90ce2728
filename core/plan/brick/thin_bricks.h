// Bricks in which a survey met walls too thin for the lattice, and what a mesh says of them.
#pragma once

#include <vector>

#include "core/base/types.h"
#include "core/plan/thin_walls.h"
#include "core/stuffing/thin_walls.h"

namespace tet {

struct VoxelTransform;

/// A brick with thin spots.
struct ThinBrick {
  BrickCoord brick;
  ThinSpots spots;
};

/// Gathers what the survey found; `bricks` sorted, `lattice` in units of the spacing.
ThinWalls gather_thin_walls(const std::vector<ThinBrick>& bricks,
                            const VoxelTransform& lattice);

}  // namespace tet
