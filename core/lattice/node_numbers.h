// Which lattice nodes are vertices of the mesh, which brick owns each, and its id.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/brick_mask.h"
#include "core/base/brick_neighbours.h"
#include "core/lattice/bcc.h"
#include "core/octree/octree.h"

namespace tet {

/// Vertices at the nodes of one octree level, by brick. A brick's ids run over its corners,
/// then its centres, then (at level 0) its cut points.
struct LevelNodes {
  std::vector<BrickMask> used;    ///< corners that leaves of this level have
  std::vector<BrickMask> corner;  ///< those that no finer leaf has: the brick owns them
  std::vector<BrickMask> centre;
  std::vector<std::uint64_t> first_vertex;  ///< id of the brick's first vertex
};

/// Leaves of a brick and of the seven beyond its lower faces, edges and corner, at
/// 4*x + 2*y + z.
using LowerLeaves = std::array<const BrickMask*, 8>;

/// `leaf` has those of each brick of the level.
LowerLeaves lower_leaves(const std::vector<BrickMask>& leaf,
                         const PlacesAround& around) noexcept;

/// The corners of these leaves that the brick itself owns.
BrickMask leaf_corners(const LowerLeaves& leaves) noexcept;

/// Adds the bricks that own a corner of some leaf but hold no leaf themselves.
void insert_corner_bricks(OctreeLevel& level);

/// Nodes of a level above 0; ids are filled in later. `finer` is the level below.
LevelNodes background_nodes(const OctreeLevel& level,
                            const OctreeLevel& finer_level,
                            const LevelNodes& finer);

/// Ids of node vertices at every level. The tree and the columns must outlive it.
class NodeNumbers {
 public:
  NodeNumbers(const Octree& tree, const std::vector<LevelNodes>& nodes)
      : tree_(&tree), nodes_(&nodes) {}

  /// Id of a leaf's corner, which a finer level may own.
  std::uint64_t corner(int level, BrickCoord brick, int x, int y, int z) const noexcept;

  /// Id of corner q of the level below, within this brick: each coordinate in [0, 16].
  std::uint64_t finer_corner(int level, BrickCoord brick, int x, int y, int z) const noexcept;

  /// Id of a leaf's centre.
  std::uint64_t centre(int level, BrickCoord brick, int x, int y, int z) const noexcept;

 private:
  bool used(int level, BrickCoord brick, int x, int y, int z) const noexcept;

  const Octree* tree_;
  const std::vector<LevelNodes>* nodes_;
};

/// Set bits of the mask before (x, y, z), in the order of ids.
std::uint32_t rank_of(const BrickMask& mask, int x, int y, int z) noexcept;

}  // namespace tet
