// Marks the cells that a grid of sizes does not let be leaves.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <vector>

#include "core/base/cancel.h"
#include "core/field/find_bricks.h"
#include "core/octree/cell_set.h"
#include "core/octree/sizing.h"
#include "core/volume/volume.h"

namespace tet {

/// Goes through a grid's voxels, cubes around their centres, wherever its lattice lies.
/// Parallel.
class GridMarker {
 public:
  /// Marks cells of a lattice of finest cells within `bounds`, boxes of finest bricks, on at
  /// most `levels` levels. Stops once it has marked more than `most` cells. The cancellation
  /// must outlive it.
  GridMarker(const VoxelTransform& lattice,
             const BrickBox& bounds,
             int levels,
             double most,
             const Cancellation& cancellation);

  void mark(const Volume& grid);

  /// Cells, some of them more than once.
  double marked() const noexcept { return marked_; }
  /// The marked cells, by level.
  std::vector<CellSetBuilder>& cells() noexcept { return of_level_; }
  /// Constants that hold very many cells, as regions.
  const std::vector<SizingRegion>& large() const noexcept { return large_; }

 private:
  class Marks;

  void mark_bricks(const Volume& grid);
  void mark_constants(const Volume& grid);
  void take(Marks& marks);
  bool full();

  const VoxelTransform lattice_;
  const BrickBox bounds_;
  const int levels_;
  const double most_;
  const Cancellation& cancellation_;
  std::mutex mutex_;
  double marked_ = 0;
  std::vector<CellSetBuilder> of_level_;
  std::vector<SizingRegion> large_;
};

}  // namespace tet
