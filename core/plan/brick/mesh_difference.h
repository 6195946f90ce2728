// Which parts of a mesh are those of an earlier one, brick by brick.
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/splice.h"
#include "core/plan/brick/counted_mesh.h"

namespace tet {

struct MeshDifference {
  KeptParts kept;
  std::vector<BrickRange> changed;  ///< bricks whose tets are not kept; in order
};

inline constexpr std::uint32_t kNewBrick = ~std::uint32_t{0};

/// Says for each brick of a level which brick of the earlier mesh's level has its vertices, or
/// its tets: kNewBrick where none has.
///
/// Where a brick is not kept, `nodes` says which brick it was: what neither moved to the
/// surface has some of its nodes as it had them.
struct KeptBricks {
  std::vector<std::uint32_t> vertices, tets, nodes;
};

/// Has one entry a level and reads neither mesh's counts. For the rest see compare_meshes.
std::vector<KeptBricks> find_kept_bricks(const ComparedMesh& earlier, const ComparedMesh& now);

/// A brick's vertices are kept where its leaves, signs, cut points and warps are what they
/// were, and away from the surface each that was there; its tets where that holds for all cells
/// and vertices that they read. Depends on the two fields and the request alone. Both meshes
/// have the same rules, spacing and origin. Parallel.
MeshDifference compare_meshes(const ComparedMesh& earlier, const ComparedMesh& now);

}  // namespace tet
