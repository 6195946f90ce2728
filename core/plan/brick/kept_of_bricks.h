// What the bricks of a level keep that are not kept as a whole.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/base/brick_mask.h"
#include "core/base/cancel.h"
#include "core/mesh/splice.h"
#include "core/plan/brick/kept_bricks.h"
#include "core/plan/brick/mesh_difference.h"

namespace tet {

/// What a brick of which not all is kept keeps.
struct KeptOfBrick {
  std::size_t brick = 0;   ///< of the level
  std::size_t before = 0;  ///< its place in the earlier one
  std::vector<KeptRun> vertices, tets;
  BrickMask new_cells;  ///< all of those whose tets are not kept
};

/// Finds that in the order of bricks; `kept` is of the level. A brick may keep a thousand runs:
/// nothing is returned once they are sure to be more than `most_runs` together, or the work is
/// to stop. Parallel.
std::optional<std::vector<KeptOfBrick>> find_kept_of_bricks(const ComparedMesh& earlier,
                                                            const ComparedMesh& now,
                                                            int level,
                                                            const KeptBricks& kept,
                                                            PatchDetail detail,
                                                            std::size_t most_runs,
                                                            const Cancellation& cancellation);

}  // namespace tet
