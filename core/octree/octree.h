// The octree: which cells are leaves, level by level, as brick masks.
#pragma once

#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "core/base/brick_index.h"
#include "core/base/brick_mask.h"
#include "core/base/cancel.h"
#include "core/base/heap_bytes.h"
#include "core/base/mask_column.h"
#include "core/base/types.h"
#include "core/octree/cell_set.h"
#include "core/octree/leaf_rules.h"

namespace tet {

struct PhiField;
class PhiSampler;

/// One level of the octree; level 0 is the finest. Columns of equal length.
struct OctreeLevel {
  std::vector<BrickCoord> bricks;  ///< sorted, unique
  MaskColumn leaf;                 ///< level 0: cells to be stuffed; above: leaves inside
  MaskColumn refined;              ///< cells divided into the eight below; none at level 0
  MaskColumn inside;               ///< leaves above level 0 that lie inside; empty: all of them
  BrickIndex index;  ///< of `bricks`, which it refers to: a level may be moved but not copied

  OctreeLevel() = default;
  OctreeLevel(OctreeLevel&&) = default;
  OctreeLevel& operator=(OctreeLevel&&) = default;

  /// Adds empty bricks where `more` (sorted) has ones that are not there yet.
  void insert_bricks(const std::vector<BrickCoord>& more);

  std::uint64_t bytes() const noexcept {
    return heap_bytes(bricks) + leaf.bytes() + refined.bytes() + inside.bytes() + index.bytes();
  }
};

bool any_leaf(const OctreeLevel& level) noexcept;

/// Leaves that cover the inside of a volume, or a domain, without overlap.
///
/// Invariants: leaves that share a face or an edge differ by at most one level; no leaf above
/// level 0 has a node, centre, face centre or edge midpoint that touches the surface.
struct Octree {
  std::vector<OctreeLevel> levels;
  /// Its leaves follow from the finest cells and from the sides of the others' nodes alone: it
  /// has several sizes of them, and nothing else asks for any.
  bool follows_surface = false;
  /// Where it follows the surface, and leaves could be larger, the cells that are divided in
  /// the level above the last one, without leaves; without bricks where these are not kept.
  OctreeLevel above;
};

/// What `masks` (one for each brick of the level) say of a brick and its halo.
HaloSet gather_halo(const OctreeLevel& level,
                    const MaskColumn& masks,
                    BrickCoord brick) noexcept;

/// The cells with all their siblings: the seven others of the same parent.
BrickMask with_siblings(BrickMask cells) noexcept;

/// Whether a finest lattice corner lies inside the mesh. Called from many threads at once, each
/// with its own sampler.
using InsideTest =
    std::function<bool(PhiSampler& sampler, std::int64_t x, std::int64_t y, std::int64_t z)>;

/// What leaves above the finest follow from beside these; it must outlive what is grown.
struct OctreeSpace {
  const PhiField& field;
  const InsideTest& is_inside;
  const OctreeCover& cover;
  const LeafRules& rules;
};

/// The candidates for leaves of a brick that lie inside. All of a candidate's nodes lie on one
/// side.
BrickMask inside_cells(PhiSampler& sampler,
                       const InsideTest& is_inside,
                       BrickCoord brick,
                       int level,
                       const BrickMask& candidates);

/// Adds a tree's levels from `level` on, where it has the ones below; `refined` are the cells
/// of `level` that are divided. If cancelled, discard the tree.
void add_levels(Octree& tree,
                int level,
                CellSet refined,
                const OctreeSpace& space,
                const Cancellation& cancellation);

/// Grows an octree above the finest leaves. Cells that are not `finest` have all their nodes on
/// one side, which `is_inside` tells; of a domain it may be null, and then no side is told, and
/// `field` not looked at. If cancelled, discard the result.
Octree build_octree(CellSet finest,
                    const PhiField& field,
                    const InsideTest& is_inside,
                    const OctreeCover& cover,
                    const LeafRules& rules,
                    const Cancellation& cancellation = {});

}  // namespace tet
