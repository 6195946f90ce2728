#include "core/octree/octree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <numbers>

#include "core/base/brick_sets.h"
#include "core/base/parallel.h"
#include "core/octree/domain_cells.h"
#include "core/scene/scene_evaluator.h"

namespace tet {
namespace {

BrickCoord parent_of(BrickCoord brick) noexcept {
  return {brick.x >> 1, brick.y >> 1, brick.z >> 1};
}

/// A row of 16 cells as the 8 of their parents.
std::uint64_t parents_of_row(std::uint64_t row) noexcept {
  std::uint64_t bits = (row | row >> 1) & 0x5555;
  bits = (bits | bits >> 1) & 0x3333;
  bits = (bits | bits >> 2) & 0x0f0f;
  return (bits | bits >> 4) & 0xff;
}

/// Cells of a level as their parents, in halo coordinates of the parent's brick.
HaloSet parents(const HaloSet& cells, BrickCoord brick) noexcept {
  HaloSet out;
  const int ox = (brick.x & 1) * 4, oy = (brick.y & 1) * 4, oz = (brick.z & 1) * 4;
  const auto row_of = [&](int x, int y) {
    const int at = halo_index(x, y, -2);
    return cells.word[static_cast<std::size_t>(at >> 6)] >> (at & 63) & 0xffff;
  };
  for (int x = -1; x < 7; ++x) {
    for (int y = -1; y < 7; ++y) {
      const std::uint64_t children = row_of(2 * x, 2 * y) | row_of(2 * x, 2 * y + 1) |
                                     row_of(2 * x + 1, 2 * y) | row_of(2 * x + 1, 2 * y + 1);
      const int at = halo_index(ox + x, oy + y, oz - 1);
      out.word[static_cast<std::size_t>(at >> 6)] |= parents_of_row(children) << (at & 63);
    }
  }
  return out;
}

/// The set with all that share a face or an edge with it: along any two axes at once.
HaloSet with_face_and_edge_neighbours(const HaloSet& cells) noexcept {
  constexpr int kX = offset_index(1, 0, 0), kY = offset_index(0, 1, 0),
                kZ = offset_index(0, 0, 1);
  const auto along = [](const HaloSet& set, int step) {
    return set | seen_from(set, step) | seen_from(set, -step);
  };
  const HaloSet z = along(cells, kZ);
  return along(z, kY) | along(z, kX) | along(along(cells, kY), kX);
}

/// Hands the bricks around a parent's their parts of `cells`, which reach out of the octant of
/// its child `brick` by one cell.
void add_parts(CellSetBuilder& builder, BrickCoord brick, const HaloSet& cells) {
  const BrickCoord parent = parent_of(brick);
  const auto first = [](std::int32_t child) { return (child & 1) - 1; };
  for (int x = first(brick.x); x <= first(brick.x) + 1; ++x) {
    for (int y = first(brick.y); y <= first(brick.y) + 1; ++y) {
      for (int z = first(brick.z); z <= first(brick.z) + 1; ++z) {
        const BrickMask part = brick_part(seen_from(cells, offset_index(8 * x, 8 * y, 8 * z)));
        if (part.any()) builder.add({parent.x + x, parent.y + y, parent.z + z}, part);
      }
    }
  }
}

/// Level 1's refined cells: the parents of the finest ones.
CellSet parents_of_finest(const CellSet& finest, const Cancellation& cancellation) {
  CellSetBuilder builder;
  for (std::size_t i = 0; i < finest.bricks.size() && !cancellation.requested(); ++i) {
    if (!finest.cells[i].any()) continue;
    HaloSet cells;
    add_brick(cells, finest.cells[i], 0, 0, 0);
    builder.add(parent_of(finest.bricks[i]), brick_part(parents(cells, finest.bricks[i])));
  }
  return builder.take();
}

/// A level's refined cells from those of the level below: a neighbour of a refined cell, across
/// a face or an edge, must exist at that size, so its parent is refined. This alone balances
/// the tree.
CellSet refined_above(const CellSet& refined, const Cancellation& cancellation) {
  CellSetBuilder builder;
  for (std::size_t i = 0; i < refined.bricks.size() && !cancellation.requested(); ++i) {
    HaloSet cells;
    add_brick(cells, refined.cells[i], 0, 0, 0);
    const BrickCoord brick = refined.bricks[i];
    add_parts(builder, brick, parents(with_face_and_edge_neighbours(cells), brick));
  }
  return builder.take();
}

/// The 4 x 4 cells at the start of a slice, each as 2 x 2 of them.
std::uint64_t doubled(std::uint64_t slice) noexcept {
  std::uint64_t bits = slice & 0x0f0f0f0f;
  bits = (bits | bits << 16) & 0x00000f0f00000f0f;
  bits = (bits | bits << 8) & 0x000f000f000f000f;
  bits = (bits | bits << 2) & 0x0033003300330033;
  bits = (bits | bits << 1) & 0x0055005500550055;
  bits |= bits << 1;
  return bits | bits << 8;
}

/// The part of a parent brick's mask that covers child (ox, oy, oz), spread to the child's
/// cells.
BrickMask children_of(const BrickMask& parent_cells, int ox, int oy, int oz) noexcept {
  BrickMask mask;
  for (std::size_t x = 0; x < 8; ++x) {
    const std::uint64_t slice = parent_cells.slice[static_cast<std::size_t>(ox * 4) + x / 2];
    mask.slice[x] = doubled(slice >> (32 * oy + 4 * oz));
  }
  return mask;
}

CellSet children_of(const CellSet& parents, const Cancellation& cancellation) {
  CellSetBuilder builder;
  for (std::size_t i = 0; i < parents.bricks.size() && !cancellation.requested(); ++i) {
    const BrickCoord p = parents.bricks[i];
    for (int o = 0; o < 8; ++o) {
      const int ox = o >> 2, oy = o >> 1 & 1, oz = o & 1;
      const BrickMask mask = children_of(parents.cells[i], ox, oy, oz);
      if (mask.any()) builder.add({2 * p.x + ox, 2 * p.y + oy, 2 * p.z + oz}, mask);
    }
  }
  return builder.take();
}

/// Every cell of the level's bricks that `inside` reaches into, and of `also`.
CellSet cells_covering(const std::vector<BrickBox>& inside,
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
  CellSet cells;
  cells.cells.assign(bricks.size(), BrickMask::all());
  cells.bricks = std::move(bricks);
  return cells;
}

/// Of a scene only what matters to a brick's corners is asked.
void focus_on(PhiSampler& sampler, BrickCoord brick, int level) {
  if (sampler.field().scene == nullptr) return;
  const double half_edge = std::ldexp(sampler.field().spacing_voxels, level) * kBrickEdge / 2;
  const auto middle = [&](std::int32_t at) { return half_edge * (2.0 * at + 1); };
  sampler.scene().focus({middle(brick.x), middle(brick.y), middle(brick.z)},
                        half_edge * std::numbers::sqrt3);
}

/// The candidates that lie inside; their nodes all lie on one side, so one corner tells.
BrickMask inside_cells(PhiSampler& sampler,
                       const InsideTest& is_inside,
                       BrickCoord brick,
                       int level,
                       const BrickMask& candidates) {
  BrickMask inside;
  if (candidates.any()) focus_on(sampler, brick, level);
  for_each_bit(candidates, [&](int x, int y, int z) {
    const auto corner = [&](std::int32_t b, int i) {
      return (std::int64_t{b} * 8 + i) << level;
    };
    if (is_inside(sampler, corner(brick.x, x), corner(brick.y, y), corner(brick.z, z))) {
      inside.set(x, y, z);
    }
  });
  return inside;
}

/// Refined cells within a domain: those given that it reaches into, and all that stick out of
/// it.
CellSet refined_in(const CellSet& refined, const DomainCells& domain) {
  CellSetBuilder builder;
  for (std::size_t i = 0; i < refined.bricks.size(); ++i) {
    const BrickMask cells = refined.cells[i] & domain.touched(refined.bricks[i]);
    if (cells.any()) builder.add(refined.bricks[i], cells);
  }
  // Only levels whose leaves are larger than what a domain is rounded to have any, and few
  // bricks.
  if (domain.all_whole()) return builder.take();
  for_each_brick(domain.bricks(), [&](BrickCoord brick) {
    const BrickMask sticking_out = domain.touched(brick) & ~domain.whole(brick);
    if (sticking_out.any()) builder.add(brick, sticking_out);
  });
  return builder.take();
}

/// Level `level`, whose leaves are the cells among `candidates` that are covered and not
/// refined.
OctreeLevel make_level(const PhiField& field,
                       const InsideTest& is_inside,
                       const OctreeCover& cover,
                       int level,
                       CellSet candidates,
                       const CellSet& refined,
                       const Cancellation& cancellation) {
  OctreeLevel made;
  made.bricks = std::move(candidates.bricks);
  made.leaf = std::move(candidates.cells);
  made.refined.resize(made.bricks.size());
  if (cover.domain) made.inside.resize(made.bricks.size());
  made.index = BrickIndex(made.bricks);
  const BrickIndex refined_index(refined.bricks);
  for_each_range(made.bricks.size(), 16, [&](std::size_t begin, std::size_t end) {
    PhiSampler sampler(field);
    for (std::size_t i = begin; i < end && !cancellation.requested(); ++i) {
      const BrickCoord brick = made.bricks[i];
      const std::uint32_t at = refined_index.find(brick);
      if (at != kNoBrick) made.refined[i] = refined.cells[at];
      made.leaf[i] &= ~made.refined[i];
      if (cover.domain) made.leaf[i] &= DomainCells(*cover.domain, level).whole(brick);
      const BrickMask inside = inside_cells(sampler, is_inside, brick, level, made.leaf[i]);
      (cover.domain ? made.inside : made.leaf)[i] = inside;
    }
  });
  return made;
}

bool any_leaf(const OctreeLevel& level) {
  return std::any_of(level.leaf.begin(), level.leaf.end(),
                     [](const BrickMask& mask) { return mask.any(); });
}

OctreeLevel finest_level(CellSet finest) {
  OctreeLevel level;
  level.bricks = std::move(finest.bricks);
  level.leaf = std::move(finest.cells);
  level.index = BrickIndex(level.bricks);
  return level;
}

}  // namespace

void CellSetBuilder::add(CellSetBuilder&& other) {
  parts_.insert(parts_.end(), std::make_move_iterator(other.parts_.begin()),
                std::make_move_iterator(other.parts_.end()));
}

CellSet CellSetBuilder::take() {
  std::sort(parts_.begin(), parts_.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  CellSet set;
  for (const auto& [brick, cells] : parts_) {
    if (set.bricks.empty() || set.bricks.back() != brick) {
      set.bricks.push_back(brick);
      set.cells.push_back(cells);
    } else {
      set.cells.back() |= cells;
    }
  }
  parts_.clear();
  return set;
}

void OctreeLevel::insert_bricks(const std::vector<BrickCoord>& more) {
  std::vector<BrickCoord> merged;
  std::set_union(bricks.begin(), bricks.end(), more.begin(), more.end(),
                 std::back_inserter(merged));
  const auto spread = [&](std::vector<BrickMask>& masks) {
    if (masks.empty()) return;
    std::vector<BrickMask> out(merged.size());
    for (std::size_t i = 0, from = 0; i < merged.size() && from < bricks.size(); ++i) {
      if (merged[i] == bricks[from]) out[i] = masks[from++];
    }
    masks = std::move(out);
  };
  spread(leaf);
  spread(refined);
  spread(inside);
  bricks = std::move(merged);
  index = BrickIndex(bricks);
}

HaloSet gather_halo(const OctreeLevel& level,
                    const std::vector<BrickMask>& masks,
                    BrickCoord brick) noexcept {
  PlacesAround around;
  for (int o = 0; o < 27; ++o) {
    around[static_cast<std::size_t>(o)] =
        level.index.find({brick.x + o / 9 - 1, brick.y + o / 3 % 3 - 1, brick.z + o % 3 - 1});
  }
  return gather_halo(masks, around);
}

HaloSet gather_halo(const std::vector<BrickMask>& masks, const PlacesAround& around) noexcept {
  HaloSet set;
  if (masks.empty()) return set;
  for (int o = 0; o < 27; ++o) {
    const std::uint32_t at = around[static_cast<std::size_t>(o)];
    if (at != kNoBrick) add_brick(set, masks[at], o / 9 - 1, o / 3 % 3 - 1, o % 3 - 1);
  }
  return set;
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

Octree build_octree(CellSet finest,
                    const PhiField& field,
                    const InsideTest& is_inside,
                    const OctreeCover& cover,
                    int max_levels,
                    const Cancellation& cancellation) {
  Octree tree;
  if (max_levels == 0) {
    // Beyond a domain there is nothing, near the surface or not.
    const auto also = cover.domain ? std::vector<BrickCoord>{} : finest.bricks;
    tree.levels.push_back(finest_level(cells_covering(cover.boxes, 0, also)));
    return tree;
  }
  CellSet refined = parents_of_finest(finest, cancellation);
  tree.levels.push_back(finest_level(std::move(finest)));
  for (int level = 1; level <= max_levels && !cancellation.requested(); ++level) {
    CellSet above = refined_above(refined, cancellation);
    if (cover.domain) above = refined_in(above, DomainCells(*cover.domain, level + 1));
    CellSet candidates = level < max_levels
                             ? children_of(above, cancellation)
                             : cells_covering(cover.boxes, level, refined.bricks);
    OctreeLevel made = make_level(field, is_inside, cover, level, std::move(candidates),
                                  refined, cancellation);
    if (!any_leaf(made)) break;
    tree.levels.push_back(std::move(made));
    refined = std::move(above);
  }
  return tree;
}

}  // namespace tet
