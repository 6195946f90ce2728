#include "core/octree/octree.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <optional>

#include "core/base/brick_sets.h"
#include "core/base/parallel.h"
#include "core/octree/domain_cells.h"
#include "core/octree/refined_cells.h"
#include "core/scene/scene_evaluator.h"

namespace tet {
namespace {

/// The level's bricks that `inside` reaches into, and `also`.
std::vector<BrickCoord> bricks_covering(const std::vector<BrickBox>& inside,
                                        int level,
                                        const std::vector<BrickCoord>& also) {
  const auto above = [&](BrickCoord b) {
    return BrickCoord{b.x >> level, b.y >> level, b.z >> level};
  };
  std::vector<BrickCoord> bricks = also;
  for (const BrickBox& box : inside) {
    for_each_brick({above(box.min), above(box.max)},
                   [&](BrickCoord brick) { bricks.push_back(brick); });
  }
  sort_unique(bricks);
  return bricks;
}

CellSet all_cells_of(std::vector<BrickCoord> bricks) {
  std::vector<BrickMask> all(bricks.size(), BrickMask::all());
  return {std::move(bricks), std::move(all)};
}

/// Focuses a scene on a brick, so that only what matters to its corners is evaluated.
void focus_on(PhiSampler& sampler, BrickCoord brick, int level) {
  if (sampler.field().scene == nullptr) return;
  const double half_edge = std::ldexp(sampler.field().spacing_voxels, level) * kBrickEdge / 2;
  const auto middle = [&](std::int32_t at) { return half_edge * (2.0 * at + 1); };
  sampler.scene().focus({middle(brick.x), middle(brick.y), middle(brick.z)}, half_edge);
}

/// Returns those of `cells` that its first one is connected to by a chain of cells with common
/// nodes.
BrickMask first_part(const BrickMask& cells) noexcept {
  BrickMask part;
  for (std::size_t x = 0; x < 8 && !part.any(); ++x) {
    part.slice[x] = cells.slice[x] & (~cells.slice[x] + 1);
  }
  for (BrickMask before; !(before == part);) {
    before = part;
    for (int axis = 0; axis < 3; ++axis) {
      part |= next_along(axis, part, {}) | previous_along(axis, part, {});
    }
    part &= cells;
  }
  return part;
}

/// Level `level`, whose leaves are the cells among `candidates` that are covered and not
/// refined.
OctreeLevel make_level(const OctreeSpace& space,
                       int level,
                       CellSet candidates,
                       const CellSet& refined,
                       const Cancellation& cancellation) {
  OctreeLevel made;
  made.bricks = std::move(candidates.bricks);
  std::vector<BrickMask> leaf = std::move(candidates.cells);
  std::vector<BrickMask> divided(made.bricks.size()), inside;
  if (space.cover.domain && space.is_inside) inside.resize(made.bricks.size());
  made.index = BrickIndex(made.bricks);
  const BrickIndex refined_index(refined.bricks);
  for_each_range(made.bricks.size(), 16, [&](std::size_t begin, std::size_t end) {
    std::optional<PhiSampler> sampler;
    if (space.is_inside) sampler.emplace(space.field);
    for (std::size_t i = begin; i < end && !cancellation.requested(); ++i) {
      const BrickCoord brick = made.bricks[i];
      const std::uint32_t at = refined_index.find(brick);
      if (at != kNoBrick) divided[i] = refined.cells[at];
      leaf[i] &= ~divided[i];
      if (space.cover.domain) leaf[i] &= DomainCells(*space.cover.domain, level).whole(brick);
      if (!sampler) continue;
      (space.cover.domain ? inside : leaf)[i] =
          inside_cells(*sampler, space.is_inside, brick, level, leaf[i]);
    }
  });
  made.leaf = MaskColumn(leaf);
  made.refined = MaskColumn(divided);
  made.inside = MaskColumn(inside);
  return made;
}

/// Level 0 where more than the surface's cells are finest: the children of level 1's refined
/// cells. All nodes of a brick that does not touch the surface lie on one side.
CellSet finest_cells(const CellSet& at_surface,
                     const CellSet& refined,
                     const OctreeSpace& space,
                     const Cancellation& cancellation) {
  CellSet cells = children_of(refined, cancellation);
  if (space.cover.domain) {  // all of it is covered
    drop_empty(cells);
    unite(cells, at_surface);
    return cells;
  }
  for_each_range(cells.bricks.size(), 16, [&](std::size_t begin, std::size_t end) {
    PhiSampler sampler(space.field);
    for (std::size_t i = begin; i < end && !cancellation.requested(); ++i) {
      const BrickCoord b = cells.bricks[i];
      if (std::ranges::binary_search(at_surface.bricks, b)) continue;
      const auto corner = [](std::int32_t brick) { return std::int64_t{kBrickEdge} * brick; };
      if (!space.is_inside(sampler, corner(b.x), corner(b.y), corner(b.z))) cells.cells[i] = {};
    }
  });
  drop_empty(cells);
  unite(cells, at_surface);
  return cells;
}

OctreeLevel finest_level(std::vector<BrickCoord> bricks, MaskColumn leaf) {
  OctreeLevel level;
  level.bricks = std::move(bricks);
  level.leaf = std::move(leaf);
  level.index = BrickIndex(level.bricks);
  return level;
}

OctreeLevel divided_level(CellSet refined) {
  OctreeLevel level;
  level.bricks = std::move(refined.bricks);
  level.refined = MaskColumn(refined.cells);
  level.index = BrickIndex(level.bricks);
  return level;
}

void add_levels(Octree& tree,
                int level,
                CellSet refined,
                const RefinedCells& refined_cells,
                const OctreeSpace& space,
                const Cancellation& cancellation) {
  const auto& [field, is_inside, cover, rules] = space;
  bool any_finer = any_leaf(tree.levels.back()), has_largest = false;
  for (; level <= rules.max_levels && !cancellation.requested(); ++level) {
    CellSet above = refined_cells.above(refined, level);
    CellSet candidates =
        level < rules.max_levels
            ? children_of(above, cancellation)
            : all_cells_of(bricks_covering(cover.boxes, level, refined.bricks));
    OctreeLevel made = make_level(space, level, std::move(candidates), refined, cancellation);
    // Where all of a domain is covered and nothing is finest, leaves begin at the level at
    // which cells reach beyond it.
    const bool any = any_leaf(made);
    has_largest = !any && (any_finer || !cover.domain);
    if (has_largest) break;
    any_finer = any;
    tree.levels.push_back(std::move(made));
    refined = std::move(above);
  }
  if (has_largest && tree.follows_surface && any_leaf(tree.levels.back())) {
    tree.above = divided_level(std::move(refined));
  }
  while (tree.levels.size() > 1 && !any_leaf(tree.levels.back())) tree.levels.pop_back();
}

}  // namespace

void OctreeLevel::insert_bricks(const std::vector<BrickCoord>& more) {
  std::vector<BrickCoord> merged;
  std::set_union(bricks.begin(), bricks.end(), more.begin(), more.end(),
                 std::back_inserter(merged));
  const auto spread = [&](MaskColumn& masks) {
    if (masks.empty()) return;
    MaskColumn out;
    out.reserve(merged.size());
    std::size_t from = 0;
    for (const BrickCoord brick : merged) {
      const bool known = from < bricks.size() && bricks[from] == brick;
      out.push_back(known ? masks[from++] : BrickMask{});
    }
    masks = std::move(out);
  };
  spread(leaf);
  spread(refined);
  spread(inside);
  bricks = std::move(merged);
  index = BrickIndex(bricks);
}

bool any_leaf(const OctreeLevel& level) noexcept {
  for (std::size_t i = 0; i < level.leaf.size(); ++i) {
    if (level.leaf[i].any()) return true;
  }
  return false;
}

HaloSet gather_halo(const OctreeLevel& level,
                    const MaskColumn& masks,
                    BrickCoord brick) noexcept {
  return gather_halo(masks, places_around(level.index, brick));
}

BrickMask with_siblings(BrickMask cells) noexcept {
  // Siblings are pairs along z, then y, then x: each bit of a pair takes the other's.
  constexpr std::uint64_t kEvenZ = 0x5555555555555555, kEvenY = 0x00ff00ff00ff00ff;
  for (std::uint64_t& slice : cells.slice) {
    slice |= (slice >> 1 & kEvenZ) | (slice & kEvenZ) << 1;
    slice |= (slice >> 8 & kEvenY) | (slice & kEvenY) << 8;
  }
  for (std::size_t x = 0; x < 8; x += 2) {
    cells.slice[x] |= cells.slice[x + 1];
    cells.slice[x + 1] = cells.slice[x];
  }
  return cells;
}

BrickMask inside_cells(PhiSampler& sampler,
                       const InsideTest& is_inside,
                       BrickCoord brick,
                       int level,
                       const BrickMask& candidates) {
  const auto corner = [level](std::int32_t b, std::size_t i) {
    return (std::int64_t{b} * kBrickEdge + static_cast<std::int64_t>(i)) << level;
  };
  // The nodes of candidates that share any lie on one side: one corner tells of all of them.
  BrickMask inside, rest = candidates;
  if (candidates.any()) focus_on(sampler, brick, level);
  while (rest.any()) {
    const BrickMask part = first_part(rest);
    std::size_t x = 0;
    while (part.slice[x] == 0) ++x;
    const auto first = static_cast<std::size_t>(std::countr_zero(part.slice[x]));
    if (is_inside(sampler, corner(brick.x, x), corner(brick.y, first / 8),
                  corner(brick.z, first % 8))) {
      inside |= part;
    }
    rest &= ~part;
  }
  return inside;
}

void add_levels(Octree& tree,
                int level,
                CellSet refined,
                const OctreeSpace& space,
                const Cancellation& cancellation) {
  const RefinedCells refined_cells({}, space.cover, space.rules, cancellation);
  add_levels(tree, level, std::move(refined), refined_cells, space, cancellation);
}

Octree build_octree(CellSet finest,
                    const PhiField& field,
                    const InsideTest& is_inside,
                    const OctreeCover& cover,
                    const LeafRules& rules,
                    const Cancellation& cancellation) {
  Octree tree;
  if (rules.max_levels == 0) {
    // There are no leaves beyond a domain, near the surface or not.
    const auto also = cover.domain ? std::vector<BrickCoord>{} : std::move(finest.bricks);
    finest = {};
    std::vector<BrickCoord> bricks = bricks_covering(cover.boxes, 0, also);
    MaskColumn leaf = MaskColumn::full(bricks.size());
    tree.levels.push_back(finest_level(std::move(bricks), std::move(leaf)));
    return tree;
  }
  RefinedCells refined_cells(finest, cover, rules, cancellation);
  CellSet refined = refined_cells.first(finest);
  const OctreeSpace space{field, is_inside, cover, rules};
  if (rules.sized()) finest = finest_cells(finest, refined, space, cancellation);
  tree.follows_surface = !rules.sized() && !cover.domain;
  tree.levels.push_back(finest_level(std::move(finest.bricks), MaskColumn(finest.cells)));
  add_levels(tree, 1, std::move(refined), refined_cells, space, cancellation);
  return tree;
}

}  // namespace tet
