// Which parts of a mesh are those of an earlier one, brick by brick.
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/splice.h"
#include "core/plan/brick/counted_mesh.h"
#include "core/plan/mesh_plan.h"

namespace tet {

struct MeshDifference {
  KeptParts kept;
  std::vector<BrickRange> changed;  ///< bricks whose tets are not kept; in order
};

inline constexpr std::uint32_t kNewBrick = ~std::uint32_t{0};

/// Of each brick of a level: the brick of the earlier mesh's level whose vertices, or tets, it
/// has, or kNewBrick.
struct KeptBricks {
  std::vector<std::uint32_t> vertices, tets;
};

/// By level; looks at neither mesh's counts. The rest is said at compare_meshes.
std::vector<KeptBricks> find_kept_bricks(const ComparedMesh& earlier, const ComparedMesh& now);

/// A brick's vertices are kept where its leaves, signs, cut points and warps are what they
/// were; its tets where that holds for all bricks that they read. Depends on the two fields and
/// the request alone. Both meshes have the same rules, spacing and origin. Parallel.
MeshDifference compare_meshes(const ComparedMesh& earlier, const ComparedMesh& now);

}  // namespace tet
