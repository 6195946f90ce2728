// What the bricks of a level keep that are not kept as a whole.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/brick_mask.h"
#include "core/mesh/stable/splice.h"
#include "core/plan/brick/kept_bricks.h"
#include "core/plan/brick/mesh_difference.h"

namespace tet {

/// What a brick of which not all is kept keeps.
struct KeptOfBrick {
  std::size_t brick = 0;   ///< of the level
  std::size_t before = 0;  ///< its place in the earlier one
  BrickMask cells;         ///< of the finest level: those of which all is as it was
  std::vector<KeptRun> vertices, tets;
};

/// Finds the bricks of a level that may keep a part, in their order, without the runs; `kept`
/// is of the level. Unspecified once the work is to stop. Parallel.
std::vector<KeptOfBrick> find_partly_kept(const ComparedPair& meshes,
                                          int level,
                                          const KeptBricks& kept);

/// The most tets that a level keeps: all of those bricks that keep any.
std::uint64_t most_kept_tets(const ComparedPair& meshes,
                             int level,
                             const KeptBricks& kept,
                             const std::vector<KeptOfBrick>& parts);

/// Adds the runs to what find_partly_kept found. A brick may keep a thousand of them: false
/// once they are sure to be more than `most_runs` together, or the work is to stop. Parallel.
bool find_kept_runs(const ComparedPair& meshes,
                    int level,
                    const KeptBricks& kept,
                    std::size_t most_runs,
                    std::vector<KeptOfBrick>& parts);

}  // namespace tet
