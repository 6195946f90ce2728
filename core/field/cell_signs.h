// Where a coarse lattice may have missed a change of sign between its nodes.
#pragma once

#include "core/base/brick_mask.h"
#include "core/field/phi_field.h"

namespace tet {

/// Cells of a lattice brick in which the trilinear field can have both signs: those whose
/// voxels, and the voxels just around them, do. Exact zeros count as outside.
///
/// Reads every voxel of the brick at most once, none of a voxel brick of one sign, and looks at
/// a region of one value once: the cost is that of the voxels that are stored, however coarse
/// the lattice is.
BrickMask cells_with_both_signs(const PhiField& field, BrickCoord brick);

}  // namespace tet
