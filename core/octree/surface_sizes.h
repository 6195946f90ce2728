// Leaves at the surface that have to be small because it bends there, or because walls are
// thin.
#pragma once

#include <vector>

#include "core/base/cancel.h"
#include "core/base/types.h"
#include "core/field/phi_field.h"
#include "core/octree/cell_set.h"
#include "core/octree/sizing.h"

namespace tet {

/// By level, from 1 to `levels`: cells that are no leaves for a sizing's chord_error and
/// leaves_across. Every finest cell whose corners are not all on one side is asked, in `bricks`
/// near the surface. Parallel. Of no use once it is cancelled.
std::vector<CellSet> surface_cells_to_refine(const Sizing& sizing,
                                             const PhiField& field,
                                             const std::vector<BrickCoord>& bricks,
                                             int levels,
                                             const Cancellation& cancellation);

}  // namespace tet
