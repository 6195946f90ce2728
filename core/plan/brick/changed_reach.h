// Which bricks' tets read a cell or a vertex that changed.
#pragma once

#include <span>
#include <vector>

#include "core/base/brick_mask.h"
#include "core/base/types.h"
#include "core/octree/octree.h"
#include "core/plan/brick/kept_bricks.h"

namespace tet {

/// A brick that is not as it was: its vertices have other numbers.
struct ChangedBrick {
  BrickCoord brick;
  BrickMask cells;    ///< that are leaves, refined or neither, and were something else
  BrickMask corners;  ///< that are, or were, vertices of it
  BrickMask nodes;    ///< corners and centres that are, or were, or have cut points that were
};

/// Marks in `tets`, one a brick of a level, those whose tets may be others as kNewBrick; and in
/// `read`, which may be null and has the level's bricks, their leaves that have such tets.
///
/// `changed` has the changed bricks of all levels up to this one, which is `level`, finest
/// first. A tet of a leaf has corners of the leaf's closed cell, and centres of the leaf and of
/// the cells across its upper faces; which tets there are depends on the 26 cells around it.
/// Around a corner leaves differ by at most two levels, so that no vertex of a still finer one
/// is read.
void mark_readers(std::span<const std::vector<ChangedBrick>> changed,
                  const OctreeLevel& level,
                  BrickPlaces& tets,
                  ReadCells* read = nullptr);

}  // namespace tet
