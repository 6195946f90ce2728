// The octree of a fully graded mesh, whose leaves are large at the surface too, and the numbers
// of its nodes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/cancel.h"
#include "core/field/find_bricks.h"
#include "core/lattice/node_numbers.h"
#include "core/octree/leaf_rules.h"
#include "core/octree/octree.h"

namespace tet {

/// Leaves that cover the inside, the surface and somewhat more, each as large as the rules let
/// it be, and a number for each of their nodes: level by level, finest first, by brick.
struct GradedTree {
  /// Ends the leaves, where there is one. Beyond its faces are images of the leaves at them,
  /// which are no leaves of the mesh: see mirrored_cells.h.
  std::optional<BrickBox> box;
  Octree tree;
  std::vector<LevelNodes> nodes;  ///< of each level
  std::uint64_t node_count = 0;
  std::uint64_t tet_count = 0;  ///< of the background, those outside included
};

/// Leaves of one size lie at least so many behind each other where surfaces are graded: leaves
/// that share a corner then differ by one level at most.
inline constexpr int kGradedLayers = 2;

/// The finest cells around the surface, for shells: those whose nodes are not all on one side.
CellSet cells_at_surface(const PhiField& field,
                         const std::vector<BrickCoord>& near_surface,
                         const Cancellation& cancellation);

/// What a graded tree is grown around.
struct GradedCover {
  const FoundBricks& found;  ///< every node inside, and in the box where there is one, is in it
  std::optional<BrickBox> box;     ///< that the leaves end at
  CellSet at_surface = {};         ///< finest cells that shells begin at
  bool finest_at_surface = false;  ///< they are leaves
};

/// Grows the tree. If cancelled, discard the result.
GradedTree grow_graded_tree(const GradedCover& cover,
                            const LeafRules& rules,
                            const Cancellation& cancellation);

}  // namespace tet
