// Which lattice nodes are vertices of the mesh, which brick owns each, and its id.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/brick_index.h"
#include "core/base/brick_mask.h"
#include "core/base/brick_neighbours.h"
#include "core/base/heap_bytes.h"
#include "core/base/mask_column.h"
#include "core/lattice/bcc.h"
#include "core/octree/octree.h"

namespace tet {

/// Vertices at the nodes of one octree level, by brick. A brick's ids run over its corners,
/// then its centres, then (at level 0) its cut points.
struct LevelNodes {
  MaskColumn used;    ///< corners that leaves of this level have; empty: `corner`
  MaskColumn corner;  ///< those that no finer leaf has: the brick owns them
  MaskColumn centre;
  std::vector<std::uint64_t> first_vertex;  ///< id of the brick's first vertex

  const BrickMask& used_corners(std::size_t brick) const noexcept {
    return used.empty() ? corner[brick] : used[brick];
  }
  std::uint64_t bytes() const noexcept {
    return used.bytes() + corner.bytes() + centre.bytes() + heap_bytes(first_vertex);
  }
};

/// Leaves of a brick and of the seven beyond its lower faces, edges and corner, at
/// 4*x + 2*y + z.
using LowerLeaves = std::array<const BrickMask*, 8>;

/// `leaf` has those of each brick of the level.
LowerLeaves lower_leaves(const MaskColumn& leaf, const PlacesAround& around) noexcept;

/// The corners of these leaves that the brick itself owns.
BrickMask leaf_corners(const LowerLeaves& leaves) noexcept;

/// Adds the bricks that own a corner of some leaf but hold no leaf themselves.
void insert_corner_bricks(OctreeLevel& level);

/// Nodes of a level above 0; ids are filled in later. `finer` is the level below.
LevelNodes background_nodes(const OctreeLevel& level,
                            const OctreeLevel& finer_level,
                            const LevelNodes& finer);

/// The bricks of one level by coordinate; asks the index once for each of those around.
class NearbyBricks {
 public:
  explicit NearbyBricks(const BrickIndex& index) noexcept : index_(&index) {}

  /// As BrickIndex::find.
  std::uint32_t find(BrickCoord brick) noexcept;

 private:
  struct Found {
    BrickCoord brick;
    bool known = false;
    std::uint32_t at = kNoBrick;
  };
  const BrickIndex* index_;
  std::array<Found, 64> found_;  // by the low two bits of each coordinate
};

/// The id of a corner that no brick owns: there is none in a tree of ours, but one that came
/// over the wire may be any.
inline constexpr std::uint64_t kNoVertex = ~std::uint64_t{0};

/// Ids of node vertices at every level. The tree and the columns must outlive it. Not
/// thread-safe: one per task.
class NodeNumbers {
 public:
  NodeNumbers(const Octree& tree, const std::vector<LevelNodes>& nodes);

  /// Id of a leaf's corner, which a finer level may own; or kNoVertex.
  std::uint64_t corner(int level, BrickCoord brick, int x, int y, int z) noexcept;

  /// Id of corner q of the level below, within this brick: each coordinate in [0, 16].
  std::uint64_t finer_corner(int level, BrickCoord brick, int x, int y, int z) noexcept;

  /// The centres of a brick's leaves, and the id of the first.
  struct Centres {
    const BrickMask* mask;
    std::uint64_t first;
  };
  Centres centres(int level, BrickCoord brick) noexcept;

 private:
  bool used(int level, BrickCoord brick, int x, int y, int z) noexcept;

  const std::vector<LevelNodes>* nodes_;
  std::vector<NearbyBricks> bricks_;  // of each level
};

/// Set bits of the mask before (x, y, z), in the order of ids.
std::uint32_t rank_of(const BrickMask& mask, int x, int y, int z) noexcept;

}  // namespace tet
