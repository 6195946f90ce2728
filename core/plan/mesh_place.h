// Where a mesh lies in the world, and how its coordinates are stored.
#pragma once

#include <string>

#include <absl/status/statusor.h>

#include "core/base/types.h"
#include "core/field/find_bricks.h"
#include "core/field/phi_field.h"
#include "core/mesh/lattice_to_world.h"
#include "core/mesh/tet_mesh.h"
#include "core/plan/mesh_request.h"

namespace tet {

/// The corners at the ends of a domain.
VoxelBox corner_box(const BrickBox& domain);

/// A domain in world units; what holds it where the lattice is turned.
WorldBox world_box_of(const BrickBox& domain, const PhiField& field);

/// Whether float32 coordinates from `origin` on would bend the angle bounds of a mesh.
bool is_far(const WorldBox& bounds, const WorldPoint& origin, double spacing) noexcept;

/// A domain in world units, on a lattice that belongs to no field.
WorldBox world_box_of(const BrickBox& domain, const VoxelTransform& lattice);

/// Which side of a grid's surface was taken for the inside, and why, where neither its class
/// nor the request says it: MeshHeader::inside_guess.
std::string inside_guess_of(const PhiField& field, const MeshRequest& request);

/// Puts the origin where the request says, or in the middle of `corners`, a box of lattice
/// corners; all vertices are no farther than `beyond` spacings outside of it. Fills in the
/// header's origin, bounds, spacing, type of coordinates and guess of the inside. Errors:
/// kInvalidArgument (an origin far from the lattice).
absl::StatusOr<LatticeToWorld> place_in_world(const PhiField& field,
                                              const VoxelBox& corners,
                                              double beyond,
                                              const MeshRequest& request,
                                              MeshHeader& header);

/// Places any lattice in the world as place_in_world does, and leaves the guess of the inside
/// alone.
absl::StatusOr<LatticeToWorld> place_lattice(const VoxelTransform& lattice,
                                             const VoxelBox& corners,
                                             double beyond,
                                             const MeshRequest& request,
                                             MeshHeader& header);

}  // namespace tet
