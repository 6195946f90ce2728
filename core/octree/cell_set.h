// Cells of one octree level by brick, and what neighbours, parents and children make of them.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "core/base/brick_mask.h"
#include "core/base/brick_neighbours.h"
#include "core/base/cancel.h"
#include "core/base/mask_column.h"
#include "core/base/types.h"

namespace tet {

/// Cells of one level, by brick.
struct CellSet {
  std::vector<BrickCoord> bricks;  ///< sorted, unique
  std::vector<BrickMask> cells;    ///< as many as bricks
};

/// Adds to a CellSet in any order; `take` sorts and unites.
class CellSetBuilder {
 public:
  void add(BrickCoord brick, const BrickMask& cells) { parts_.push_back({brick, cells}); }
  void add(CellSetBuilder&& other);
  std::size_t parts() const noexcept { return parts_.size(); }
  CellSet take();

 private:
  std::vector<std::pair<BrickCoord, BrickMask>> parts_;
};

/// What `masks`, one for each brick of a list, say of a brick whose neighbours are known, and
/// of its halo.
HaloSet gather_halo(const std::vector<BrickMask>& masks, const PlacesAround& around) noexcept;
HaloSet gather_halo(const MaskColumn& masks, const PlacesAround& around) noexcept;

// Each is of no use once it is cancelled.

CellSet parents_of(const CellSet& cells, const Cancellation& cancellation);

/// The parents of the cells and of all that share a face or an edge with one: a neighbour of a
/// refined cell must exist at that size, so its parent is refined. This alone balances a tree.
CellSet parents_with_neighbours(const CellSet& cells, const Cancellation& cancellation);

CellSet children_of(const CellSet& parents, const Cancellation& cancellation);

/// The children of its parent brick's cells that are the brick's own.
BrickMask children_within(const BrickMask& parent_cells, BrickCoord brick) noexcept;

/// The cells with all that share a face or an edge with them, as often as there are steps.
/// Parallel.
CellSet grown(CellSet cells, int steps, const Cancellation& cancellation);

void unite(CellSet& cells, const CellSet& more);

/// Drops bricks without a cell.
void drop_empty(CellSet& cells);

}  // namespace tet
