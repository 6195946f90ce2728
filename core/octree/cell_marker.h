// Marks the cells of one level that a region reaches into, where there is anything to mesh.
#pragma once

#include <vector>

#include "core/base/cancel.h"
#include "core/field/find_bricks.h"
#include "core/octree/cell_set.h"
#include "core/octree/region_shape.h"

namespace tet {

/// Marks the cells that one region asks for. It looks at large boxes of cells first, and
/// divides those that the region covers in part.
class CellMarker {
 public:
  /// Stops once it has marked more than `most` cells. Both references must outlive it.
  CellMarker(const RegionShape& shape, int level, double most, const Cancellation& cancellation)
      : shape_(shape), level_(level), most_(most), cancellation_(cancellation) {}

  /// Within `cover`, boxes of finest bricks.
  void mark(const std::vector<BrickBox>& cover);

  /// Cells, some of them more than once.
  double marked() const noexcept { return marked_; }
  CellSetBuilder take() { return std::move(cells_); }

 private:
  void mark(const BrickBox& bricks);
  void mark_all(const BrickBox& bricks);
  void mark_part(BrickCoord brick);

  const RegionShape& shape_;
  const int level_;
  const double most_;
  const Cancellation& cancellation_;
  double marked_ = 0;
  CellSetBuilder cells_;
};

}  // namespace tet
