// Which cells of each octree level are no leaves: because of smaller ones, or because they are
// asked to be smaller.
#pragma once

#include <vector>

#include "core/base/cancel.h"
#include "core/octree/leaf_rules.h"

namespace tet {

/// Refined cells, level by level. Refers to all that it is made of, which must outlive it. If
/// cancelled, discard it.
class RefinedCells {
 public:
  /// `at_surface` are the finest cells.
  RefinedCells(const CellSet& at_surface,
               const OctreeCover& cover,
               const LeafRules& rules,
               const Cancellation& cancellation);

  /// Returns the refined cells of level 1.
  CellSet first(const CellSet& at_surface) const;
  /// Returns the refined cells of the level above `level`, whose own are `refined`.
  CellSet above(const CellSet& refined, int level) const;

 private:
  CellSet layered(const CellSet& cells) const;
  CellSet with_demanded(CellSet refined, int level) const;

  const OctreeCover& cover_;
  const LeafRules& rules_;
  const Cancellation& cancellation_;
  std::vector<CellSet> of_shells_;  ///< by level
};

}  // namespace tet
