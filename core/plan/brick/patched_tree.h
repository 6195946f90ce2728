// An octree from an earlier one, where few of the finest cells have changed.
#pragma once

#include <span>

#include "core/base/cancel.h"
#include "core/octree/octree.h"

namespace tet {

/// Finest cells by brick, sorted: those of a survey, and any brick may have none.
struct FinestCells {
  std::span<const BrickCoord> bricks;
  std::span<const BrickMask> cells;
};

/// An octree, and what has changed since it was grown.
struct EarlierTree {
  const Octree& tree;  ///< with every brick that owns a corner
  /// Finest bricks, sorted and unique. Beyond them the finest cells are those of the earlier
  /// tree, and every node lies on the side on which it lay.
  std::span<const BrickCoord> changed;
};

/// Whether patch_tree may be asked: both trees follow the surface alone, and so few bricks have
/// changed that it saves anything. `finest` are the cells of the new one.
bool can_patch(const EarlierTree& earlier, const FinestCells& finest, const OctreeSpace& space);

/// Makes what build_octree makes, with every brick that owns a corner of a leaf (see
/// insert_corner_bricks). Cells that are divided are found again only where finer ones have
/// changed, and leaves where such cells have, or the sides of nodes. If cancelled, discard the
/// result.
Octree patch_tree(const FinestCells& finest,
                  const EarlierTree& earlier,
                  const OctreeSpace& space,
                  const Cancellation& cancellation);

}  // namespace tet
