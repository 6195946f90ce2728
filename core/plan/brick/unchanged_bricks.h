// Which bricks of a mesh own what they owned in an earlier one, by what that follows from.
#pragma once

#include <cstddef>
#include <vector>

#include "core/octree/octree.h"
#include "core/plan/brick/kept_bricks.h"

namespace tet {

class CountedMesh;

/// Whether a brick's cells are divided, and lie inside, as those of a brick of an earlier
/// level.
bool same_cells(const OctreeLevel& earlier,
                std::size_t before,
                const OctreeLevel& now,
                std::size_t brick) noexcept;

/// Has one entry a level: the place in the earlier level of each brick whose cells, signs, cut
/// points and warps are what they were, and that must own the same vertices, as all that these
/// follow from is the same. Not every brick that owns the same is among them. Looks at neither
/// mesh's geometry, and at the vertices of neither: those of `now` may be still to come.
std::vector<BrickPlaces> find_unchanged_bricks(const CountedMesh& earlier,
                                               const CountedMesh& now);

}  // namespace tet
