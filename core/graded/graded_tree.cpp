#include "core/graded/graded_tree.h"

#include <cstddef>
#include <memory>
#include <utility>

#include "core/base/parallel.h"
#include "core/field/phi_field.h"
#include "core/graded/mirrored_cells.h"
#include "core/lattice/background.h"
#include "core/octree/domain_cells.h"
#include "core/octree/refined_cells.h"

namespace tet {
namespace {

constexpr std::size_t kLeavesPerRange = 16;

/// Cells of the largest size around all that is inside, and around the surface.
CellSet root_cells(const FoundBricks& found, int level, const Cancellation& cancellation) {
  CellSetBuilder builder;
  const auto add = [&](const BrickBox& box) {
    const DomainCells cells(box, level);
    for_each_brick(cells.bricks(),
                   [&](BrickCoord brick) { builder.add(brick, cells.touched(brick)); });
  };
  for (const BrickCoord brick : found.near_surface) add({brick, brick});
  for (const BrickBox& box : found.inside) add(box);
  // The leaves around a node inside, whichever of their corners it is, and those beyond the
  // faces of a leaf whose centre it is: neighbours across faces, edges and corners.
  return grown(builder.take(), 2, cancellation);
}

/// Makes a level of its cells and of those of them that are refined; the others are leaves.
/// With a box only whole cells can be leaves: a cell that sticks out of it is refined.
OctreeLevel level_of(CellSet cells,
                     CellSet refined,
                     const std::optional<BrickBox>& box,
                     int number) {
  if (box) {
    const DomainCells in_box(*box, number);
    for (std::size_t i = 0; i < cells.bricks.size(); ++i) {
      cells.cells[i] &= in_box.whole(cells.bricks[i]);
    }
    add_mirrored(*box, number, cells);
    add_mirrored(*box, number, refined);
  }
  OctreeLevel level;
  level.bricks = std::move(cells.bricks);
  level.leaf.reserve(level.bricks.size());
  level.refined.reserve(level.bricks.size());
  const BrickIndex index(refined.bricks);
  for (std::size_t i = 0; i < level.bricks.size(); ++i) {
    const std::uint32_t at = index.find(level.bricks[i]);
    const BrickMask divided = at != kNoBrick ? refined.cells[at] : BrickMask{};
    level.leaf.push_back(cells.cells[i] & ~divided);
    level.refined.push_back(divided);
  }
  level.index = BrickIndex(level.bricks);
  insert_corner_bricks(level);
  return level;
}

/// Leaves from the finest level up: the children of what is refined above, but for what is
/// refined itself; on top the roots.
Octree grow(const GradedCover& graded,
            const LeafRules& rules,
            const Cancellation& cancellation) {
  const OctreeCover cover{graded.found.inside, graded.box};
  CellSet roots = root_cells(graded.found, rules.max_levels, cancellation);
  Octree tree;
  if (rules.max_levels == 0) {
    tree.levels.push_back(level_of(std::move(roots), {}, cover.domain, 0));
    return tree;
  }
  const RefinedCells refined_cells(graded.at_surface, cover, rules, cancellation);
  CellSet refined =
      refined_cells.first(graded.finest_at_surface ? graded.at_surface : CellSet{});
  tree.levels.push_back(level_of(children_of(refined, cancellation), {}, cover.domain, 0));
  for (int level = 1; level < rules.max_levels && !cancellation.requested(); ++level) {
    CellSet above = refined_cells.above(refined, level);
    tree.levels.push_back(
        level_of(children_of(above, cancellation), std::move(refined), cover.domain, level));
    refined = std::move(above);
  }
  unite(roots, refined);
  tree.levels.push_back(
      level_of(std::move(roots), std::move(refined), cover.domain, rules.max_levels));
  return tree;
}

LevelNodes finest_nodes(const OctreeLevel& level) {
  std::vector<BrickMask> corner(level.bricks.size());
  for_each_range(level.bricks.size(), kLeavesPerRange, [&](std::size_t begin, std::size_t end) {
    BrickNeighbours neighbours(level.bricks);
    for (std::size_t i = begin; i < end; ++i) {
      corner[i] = leaf_corners(lower_leaves(level.leaf, neighbours.around(level.bricks[i])));
    }
  });
  return {{}, MaskColumn(corner), level.leaf, {}};
}

void number_nodes(GradedTree& graded) {
  for (std::size_t l = 0; l < graded.tree.levels.size(); ++l) {
    const OctreeLevel& level = graded.tree.levels[l];
    graded.nodes.push_back(
        l == 0 ? finest_nodes(level)
               : background_nodes(level, graded.tree.levels[l - 1], graded.nodes[l - 1]));
    LevelNodes& nodes = graded.nodes.back();
    for (std::size_t i = 0; i < level.bricks.size(); ++i) {
      nodes.first_vertex.push_back(graded.node_count);
      graded.node_count += std::uint64_t{nodes.corner[i].count()} + nodes.centre[i].count();
    }
  }
}

void count_tets(GradedTree& graded) {
  for (const OctreeLevel& level : graded.tree.levels) {
    const auto first = offsets_from_counts(level.bricks.size(), [&](std::size_t i) {
      return count_background(gather_background(level, level.bricks[i], MeshRegion::kInside))
          .total();
    });
    graded.tet_count += first.back();
  }
}

}  // namespace

CellSet cells_at_surface(const PhiField& field,
                         const std::vector<BrickCoord>& near_surface,
                         const Cancellation& cancellation) {
  CellSet cells{near_surface, std::vector<BrickMask>(near_surface.size())};
  for_each_range(near_surface.size(), kLeavesPerRange, [&](std::size_t begin, std::size_t end) {
    PhiSampler sampler(field);
    sampler.stop_when(cancellation);
    const auto samples = std::make_unique<BrickSamples>();
    for (std::size_t i = begin; i < end && !cancellation.requested(); ++i) {
      sampler.sample(near_surface[i], *samples);
      for_each_bit(BrickMask::all(), [&](int x, int y, int z) {
        const auto inside = [&](int corner) {
          const int at = halo_index(x + (corner >> 2), y + (corner >> 1 & 1), z + (corner & 1));
          return samples->corner[static_cast<std::size_t>(at)] < 0;
        };
        for (int corner = 1; corner < 8; ++corner) {
          if (inside(corner) != inside(0)) cells.cells[i].set(x, y, z);
        }
      });
    }
  });
  drop_empty(cells);
  return cells;
}

GradedTree grow_graded_tree(const GradedCover& cover,
                            const LeafRules& rules,
                            const Cancellation& cancellation) {
  GradedTree graded;
  graded.box = cover.box;
  graded.tree = grow(cover, rules, cancellation);
  if (cancellation.requested()) return graded;
  number_nodes(graded);
  count_tets(graded);
  return graded;
}

}  // namespace tet
