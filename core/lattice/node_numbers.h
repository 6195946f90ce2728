// Which lattice nodes are vertices of the mesh, which brick owns each, and its id.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/brick_box.h"
#include "core/base/brick_index.h"
#include "core/base/brick_mask.h"
#include "core/base/brick_neighbours.h"
#include "core/base/heap_bytes.h"
#include "core/base/mask_column.h"
#include "core/lattice/bcc.h"
#include "core/lattice/reach.h"
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

/// `leaf` has those of each brick of the level.
LowerLeaves lower_leaves(const MaskColumn& leaf, const PlacesAround& around) noexcept;

/// The corners of these leaves that the brick itself owns.
BrickMask leaf_corners(const LowerLeaves& leaves) noexcept;

/// Whether one of a brick's leaves has a corner in the brick that is a step up along each axis
/// of `o` (4*x + 2*y + z).
bool has_corner_in(const BrickMask& leaf, unsigned o) noexcept;

/// Adds the bricks that own a corner of some leaf but hold no leaf themselves.
void insert_corner_bricks(OctreeLevel& level);

/// Nodes of a level that are those of another tree's.
struct KnownNodes {
  const LevelNodes* nodes = nullptr;  ///< of the other tree; null: none are
  /// Where they are there of each brick, kNoBrick of those whose nodes are to be found.
  std::span<const std::uint32_t> places = {};
};

/// The bricks among [begin, end) of a level whose nodes are to be found.
std::vector<std::size_t> unknown_bricks(const KnownNodes& known,
                                        std::size_t begin,
                                        std::size_t end);

/// Nodes of a level above 0; ids are filled in later. `finer` is the level below.
LevelNodes background_nodes(const OctreeLevel& level,
                            const OctreeLevel& finer_level,
                            const LevelNodes& finer,
                            const KnownNodes& known = {});

/// The bricks of one level by coordinate; asks the index once for each of those around.
class NearbyBricks {
 public:
  explicit NearbyBricks(const BrickIndex& index) noexcept : index_(&index) {}

  /// Finds a brick as BrickIndex::find does.
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

  /// Calls `visit(x, y, z, id)` for every corner that `finer_corner` finds at this level or the
  /// one below: nearly all of them, at a small part of the cost of looking each up.
  template <class Visit>
  void for_each_corner(int level, BrickCoord brick, const Visit& visit) noexcept {
    const auto [x, y, z] = brick;
    for_each_owned(level, brick, 1, [&](int cx, int cy, int cz, std::uint64_t id) {
      visit(2 * cx, 2 * cy, 2 * cz, id);
    });
    if (level > 0) for_each_owned(level - 1, {2 * x, 2 * y, 2 * z}, 2, visit);
  }

  /// The centres of a brick's leaves, and the id of the first.
  struct Centres {
    const BrickMask* mask;
    std::uint64_t first;
  };
  Centres centres(int level, BrickCoord brick) noexcept;

 private:
  bool used(int level, BrickCoord brick, int x, int y, int z) noexcept;

  /// Visits those of a level's own corners that lie in a cube of `edge` bricks, upper faces
  /// included.
  template <class Visit>
  void for_each_owned(int level, BrickCoord low, int edge, const Visit& visit) noexcept;

  const std::vector<LevelNodes>* nodes_;
  std::vector<NearbyBricks> bricks_;  // of each level
};

/// Set bits of the mask before (x, y, z), in the order of ids.
std::uint32_t rank_of(const BrickMask& mask, int x, int y, int z) noexcept;

template <class Visit>
void NodeNumbers::for_each_owned(int level,
                                 BrickCoord low,
                                 int edge,
                                 const Visit& visit) noexcept {
  const auto l = static_cast<std::size_t>(level);
  const LevelNodes& nodes = (*nodes_)[l];
  const BrickBox bricks{{0, 0, 0}, {edge, edge, edge}};
  for_each_brick(bricks, [&](BrickCoord o) {
    const std::uint32_t at = bricks_[l].find({low.x + o.x, low.y + o.y, low.z + o.z});
    if (at == kNoBrick) return;
    // Bricks beyond an upper face contribute only the corners on it.
    const int x = o.x / edge, y = o.y / edge, z = o.z / edge;
    const auto beyond = static_cast<std::size_t>(4 * x + 2 * y + z);
    for_each_in_reach(nodes.corner[at], beyond,
                      [&](int cx, int cy, int cz, std::uint32_t rank) {
                        visit(8 * (o.x - x) + cx, 8 * (o.y - y) + cy, 8 * (o.z - z) + cz,
                              nodes.first_vertex[at] + rank);
                      });
  });
}

}  // namespace tet
