// Where a mesh lies in the world, and how its coordinates are stored.
#pragma once

#include <optional>

#include "core/base/types.h"
#include "core/field/phi_field.h"
#include "core/mesh/lattice_to_world.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// Puts the origin in the middle of `corners`, a box of lattice corners; all vertices are no
/// farther than `beyond` spacings outside of it. Fills in the header's origin, bounds, spacing
/// and, unless it is asked for, the type of coordinates.
LatticeToWorld place_in_world(const PhiField& field,
                              const VoxelBox& corners,
                              double beyond,
                              const std::optional<CoordinateType>& coordinates,
                              MeshHeader& header);

}  // namespace tet
