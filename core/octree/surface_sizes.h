// Leaves at the surface that have to be small because it bends there, or because walls are
// thin.
#pragma once

#include <optional>
#include <vector>

#include "core/base/brick_box.h"
#include "core/base/cancel.h"
#include "core/base/types.h"
#include "core/field/phi_field.h"
#include "core/octree/cell_set.h"
#include "core/octree/sizing.h"

namespace tet {

/// Finds the cells, by level from 1 to `levels`, that must not be leaves because of a sizing's
/// chord_error and leaves_across. Every finest cell in `bricks` near the surface is looked at
/// whose corners are not all on one side. Cells that do not fit into the domain, if there is
/// one, are left out: they are no leaves in any case. Parallel. If cancelled, discard the
/// result.
std::vector<CellSet> surface_cells_to_refine(const Sizing& sizing,
                                             const PhiField& field,
                                             const std::vector<BrickCoord>& bricks,
                                             const std::optional<BrickBox>& domain,
                                             int levels,
                                             const Cancellation& cancellation);

}  // namespace tet
