// The second pass: every vertex and tet of a mesh of labels counted, brick by brick.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/brick_neighbours.h"
#include "core/base/cancel.h"
#include "core/labels/label_vertices.h"
#include "core/lattice/node_numbers.h"
#include "core/octree/octree.h"
#include "core/plan/brick/counted_mesh.h"
#include "core/plan/labelled/survey_labels.h"

namespace tet {

/// Leaves of one label of one brick above the finest level.
struct LabelLeaves {
  Label label;
  BrickMask cells;
};

/// The octree with the vertices and tets of each brick, finest level first.
class CountedLabels {
 public:
  /// The mesh is of no use once it is cancelled.
  CountedLabels(LabelSurvey survey, Octree tree, const Cancellation& cancellation);

  const Octree& tree() const noexcept { return tree_; }
  const LabelRules& rules() const noexcept { return survey_.rules; }
  NodeNumbers numbers() const noexcept { return {tree_, nodes_}; }
  const LevelNodes& nodes(int level) const noexcept {
    return nodes_[static_cast<std::size_t>(level)];
  }

  std::size_t brick_count() const noexcept { return first_vertex_.size() - 1; }
  BrickPlace place(std::size_t brick) const noexcept;
  std::uint64_t first_vertex(std::size_t brick) const noexcept { return first_vertex_[brick]; }
  std::uint64_t first_tet(std::size_t brick) const noexcept { return first_tet_[brick]; }

  /// A finest brick and those beyond its upper faces.
  LabelledParts parts(const PlacesAround& around) const noexcept;
  /// Leaves of a brick above the finest level, by label in ascending order.
  std::span<const LabelLeaves> leaves_of(BrickPlace place) const noexcept;

  /// A byte for each vertex: 1 where it lies between labels, 0 within one.
  std::vector<std::uint8_t> vertices_between_labels() const;

  std::uint64_t bytes() const noexcept;

 private:
  void find_leaves(const Cancellation& cancellation);
  void find_vertices(const Cancellation& cancellation);
  void count_bricks(const Cancellation& cancellation);
  LabelledPart part_of(std::size_t brick) const noexcept;
  NodeMasks vertices_of_finest(std::size_t brick, const PlacesAround& around) const;
  std::uint64_t tets_of(BrickPlace place, const PlacesAround& around) const;

  /// Runs of leaves of one level's bricks.
  struct LevelLeaves {
    std::vector<std::uint32_t> first;  // one more than bricks
    std::vector<LabelLeaves> run;
  };

  LabelSurvey survey_;
  Octree tree_;
  std::vector<LevelLeaves> leaves_;  // by level; none at the finest
  std::vector<LevelNodes> nodes_;
  std::vector<std::size_t> first_brick_;                 // of each level
  std::vector<std::uint64_t> first_vertex_, first_tet_;  // one more than bricks: totals
};

}  // namespace tet
