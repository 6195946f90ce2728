// The part of space that is meshed when both sides of a surface are: a box of finest bricks.
#pragma once

#include <array>
#include <optional>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "core/base/types.h"
#include "core/field/find_bricks.h"
#include "core/field/phi_field.h"

namespace tet {

/// `box`, or all that the volume stores or the scene reaches, rounded outward to whole bricks
/// of 8 finest cells; to larger powers of two where it is longer than 512 of them, so that the
/// leaves at its faces may grow with it.
///
/// Errors: kInvalidArgument (a box that is empty, not finite or beyond index space),
/// kFailedPrecondition (no box, and nothing is stored, or no end).
absl::StatusOr<BrickBox> mesh_domain(const PhiField& field, const std::optional<WorldBox>& box);

/// A domain far from voxel 0, at so many voxels a spacing along each axis, has voxels that no
/// 32 bits count. Errors: kInvalidArgument.
absl::Status check_voxel_reach(const BrickBox& domain,
                               const std::array<double, 3>& spacing_voxels);

/// Voxels of the bricks that a volume stores, and of constants that are not the background.
VoxelBox stored_box(const Volume& volume);

/// All that is inside of a scene, or of what it stands for. Errors as above.
absl::StatusOr<BrickBox> reached_bricks(const PhiField& field);

}  // namespace tet
