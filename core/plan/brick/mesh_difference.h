// Which parts of a mesh are those of an earlier one, brick by brick.
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/splice.h"
#include "core/plan/brick/counted_mesh.h"
#include "core/plan/brick/kept_bricks.h"

namespace tet {

struct MeshDifference {
  KeptParts kept;
  std::vector<BrickRange> changed;  ///< bricks whose tets are not kept; in order
};

/// Has one entry a level and reads neither mesh's counts. For the rest see compare_meshes.
/// Bricks that are `unchanged` (see find_unchanged_bricks) are not looked at again; with an
/// empty list all are.
std::vector<KeptBricks> find_kept_bricks(const ComparedMesh& earlier,
                                         const ComparedMesh& now,
                                         std::vector<BrickPlaces> unchanged = {});

/// A brick's vertices are kept where its leaves, signs, cut points and warps are what they
/// were, and away from the surface each that was there; its tets where that holds for all cells
/// and vertices that they read. Depends on the two fields and the request alone. Both meshes
/// have the same rules, spacing and origin. What `now` found when it was counted after
/// `earlier` is not looked for again. Parallel.
MeshDifference compare_meshes(const ComparedMesh& earlier, const ComparedMesh& now);

}  // namespace tet
