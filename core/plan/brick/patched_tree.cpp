#include "core/plan/brick/patched_tree.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <utility>
#include <vector>

#include "core/base/brick_sets.h"
#include "core/base/parallel.h"
#include "core/field/phi_field.h"
#include "core/lattice/node_numbers.h"

namespace tet {
namespace {

using Bricks = std::vector<BrickCoord>;

/// Patching so large a part of a tree is no faster than growing it.
constexpr std::size_t kLeastUnchanged = 4;  // bricks for each that has changed

constexpr std::size_t kPatchedPerRange = 16;

/// The brick of the level `levels` above that a brick lies in.
BrickCoord brick_above(BrickCoord b, int levels = 1) noexcept {
  return {b.x >> levels, b.y >> levels, b.z >> levels};
}

BrickCoord stepped(BrickCoord b, unsigned o, int sign = 1) noexcept {
  const auto along = [&](unsigned bit) {
    return sign * static_cast<std::int32_t>(o >> bit & 1);
  };
  return {b.x + along(2), b.y + along(1), b.z + along(0)};
}

void add_bricks_below(BrickCoord parent, Bricks& bricks) {
  const BrickCoord first{2 * parent.x, 2 * parent.y, 2 * parent.z};
  for (unsigned o = 0; o < 8; ++o) bricks.push_back(stepped(first, o));
}

Bricks bricks_below(const Bricks& parents) {
  Bricks bricks;
  for (const BrickCoord parent : parents) add_bricks_below(parent, bricks);
  sort_unique(bricks);
  return bricks;
}

/// Null where a set has none of a brick's cells.
const BrickMask* find_cells(const FinestCells& set, BrickCoord brick) {
  const auto at = std::ranges::lower_bound(set.bricks, brick);
  if (at == set.bricks.end() || *at != brick) return nullptr;
  return &set.cells[static_cast<std::size_t>(at - set.bricks.begin())];
}
const BrickMask* find_cells(const CellSet& set, BrickCoord brick) {
  return find_cells(FinestCells{set.bricks, set.cells}, brick);
}

/// What a level's column says of a brick; nothing of one that the level does not have.
BrickMask mask_in(const OctreeLevel& level, const MaskColumn& masks, BrickCoord brick) {
  const std::uint32_t at = level.index.find(brick);
  return at == kNoBrick ? BrickMask{} : masks[at];
}

/// The cells of one level that are divided: those of an earlier level, but for some bricks.
struct RefinedPatch {
  const OctreeLevel* before;
  CellSet changed;  ///< all of a brick's cells, perhaps none

  BrickMask of(BrickCoord brick) const {
    const BrickMask* const now = find_cells(changed, brick);
    return now != nullptr ? *now : mask_in(*before, before->refined, brick);
  }

  CellSet all() const {
    CellSet all;
    const auto add = [&](BrickCoord brick, const BrickMask& cells) {
      if (!cells.any()) return;
      all.bricks.push_back(brick);
      all.cells.push_back(cells);
    };
    std::size_t next = 0;
    const auto add_changed_below = [&](const BrickCoord* end) {
      for (; next < changed.bricks.size() && (!end || changed.bricks[next] < *end); ++next) {
        add(changed.bricks[next], changed.cells[next]);
      }
    };
    for (std::size_t i = 0; i < before->bricks.size(); ++i) {
      const BrickCoord brick = before->bricks[i];
      add_changed_below(&brick);
      const bool is_changed = next < changed.bricks.size() && changed.bricks[next] == brick;
      if (!is_changed) add(brick, before->refined[i]);
    }
    add_changed_below(nullptr);
    return all;
  }
};

/// Keeps those of some bricks whose cells are no longer those of the earlier level; `now` has
/// the cells of all of them that have any.
RefinedPatch patch_of(const OctreeLevel& before, const Bricks& bricks, const CellSet& now) {
  RefinedPatch patch{&before, {}};
  for (const BrickCoord brick : bricks) {
    const BrickMask* const found = find_cells(now, brick);
    const BrickMask cells = found != nullptr ? *found : BrickMask{};
    if (cells == mask_in(before, before.refined, brick)) continue;
    patch.changed.bricks.push_back(brick);
    patch.changed.cells.push_back(cells);
  }
  return patch;
}

/// Cells of level 1 are divided where they have finest ones.
RefinedPatch first_patch(const OctreeLevel& before,
                         const FinestCells& finest,
                         std::span<const BrickCoord> changed,
                         const Cancellation& cancellation) {
  Bricks parents;
  for (const BrickCoord brick : changed) parents.push_back(brick_above(brick));
  sort_unique(parents);
  CellSet below;
  for (const BrickCoord brick : bricks_below(parents)) {
    const BrickMask* const cells = find_cells(finest, brick);
    if (cells == nullptr) continue;
    below.bricks.push_back(brick);
    below.cells.push_back(*cells);
  }
  return patch_of(before, parents, parents_of(below, cancellation));
}

/// Cells of the level above are divided around those of their size that are: see
/// parents_with_neighbours.
RefinedPatch patch_above(const RefinedPatch& refined,
                         const OctreeLevel& before,
                         const Cancellation& cancellation) {
  CellSet cells_before;
  for (const BrickCoord brick : refined.changed.bricks) {
    cells_before.bricks.push_back(brick);
    cells_before.cells.push_back(mask_in(*refined.before, refined.before->refined, brick));
  }
  // Only where they reach anything else than they did it can be another.
  const CellSet did = parents_with_neighbours(cells_before, cancellation);
  const CellSet do_now = parents_with_neighbours(refined.changed, cancellation);
  Bricks reached;
  std::ranges::set_union(did.bricks, do_now.bricks, std::back_inserter(reached));
  std::erase_if(reached, [&](BrickCoord brick) {
    const BrickMask *const a = find_cells(did, brick), *const b = find_cells(do_now, brick);
    return a != nullptr && b != nullptr && *a == *b;
  });
  CellSet below;
  for (const BrickCoord brick : with_neighbours(bricks_below(reached))) {
    const BrickMask cells = refined.of(brick);
    if (!cells.any()) continue;
    below.bricks.push_back(brick);
    below.cells.push_back(cells);
  }
  return patch_of(before, reached, parents_with_neighbours(below, cancellation));
}

/// A brick of a level as it is now.
struct PatchedBrick {
  BrickCoord brick;
  bool is_there = false;  ///< among the level's bricks
  BrickMask leaf, refined;
};

/// Makes one level from the earlier one and the bricks whose leaves have changed.
class LevelPatch {
 public:
  /// `may_hold(brick)` says whether a brick is one of the level's whatever corners it owns.
  /// `patched` are sorted: all that may have changed, and there for the same reason.
  template <class MayHold>
  LevelPatch(const OctreeLevel& before,
             std::vector<PatchedBrick> patched,
             const MayHold& may_hold)
      : before_(before), patched_(std::move(patched)) {
    add_owners(may_hold);
  }

  OctreeLevel make() const {
    OctreeLevel made;
    made.bricks.reserve(before_.bricks.size() + patched_.size());
    made.leaf.reserve(before_.bricks.size() + patched_.size());
    std::size_t at = 0;
    for (const PatchedBrick& now : patched_) {
      const std::size_t end = place_from(at, now.brick);
      append(at, end, made);
      const bool was_there = end < before_.bricks.size() && before_.bricks[end] == now.brick;
      at = end + was_there;
      if (!now.is_there) continue;
      made.bricks.push_back(now.brick);
      made.leaf.push_back(now.leaf);
      if (!before_.refined.empty()) made.refined.push_back(now.refined);
    }
    append(at, before_.bricks.size(), made);
    made.index = BrickIndex(made.bricks);
    return made;
  }

 private:
  std::size_t place_from(std::size_t begin, BrickCoord brick) const {
    const auto first = before_.bricks.begin() + static_cast<std::ptrdiff_t>(begin);
    return static_cast<std::size_t>(std::lower_bound(first, before_.bricks.end(), brick) -
                                    before_.bricks.begin());
  }

  void append(std::size_t begin, std::size_t end, OctreeLevel& made) const {
    const auto at = [&](std::size_t i) {
      return before_.bricks.begin() + static_cast<std::ptrdiff_t>(i);
    };
    made.bricks.insert(made.bricks.end(), at(begin), at(end));
    made.leaf.append_run(before_.leaf, begin, end - begin);
    if (!before_.refined.empty()) {
      made.refined.append_run(before_.refined, begin, end - begin);
    }
  }

  const PatchedBrick* find(BrickCoord brick) const {
    const auto at = std::ranges::lower_bound(patched_, brick, {}, &PatchedBrick::brick);
    return at != patched_.end() && at->brick == brick ? &*at : nullptr;
  }

  BrickMask leaf_of(BrickCoord brick) const {
    const PatchedBrick* const now = find(brick);
    return now != nullptr ? now->leaf : mask_in(before_, before_.leaf, brick);
  }

  bool owns_corner(BrickCoord brick) const {
    for (unsigned o = 1; o < 8; ++o) {
      if (has_corner_in(leaf_of(stepped(brick, o, -1)), o)) return true;
    }
    return false;
  }

  /// Bricks without a leaf are there where they own a corner of one.
  template <class MayHold>
  void add_owners(const MayHold& may_hold) {
    Bricks beside;
    for (const PatchedBrick& now : patched_) {
      if (now.leaf == mask_in(before_, before_.leaf, now.brick)) continue;
      for (unsigned o = 1; o < 8; ++o) beside.push_back(stepped(now.brick, o));
    }
    sort_unique(beside);
    std::vector<PatchedBrick> owners;
    for (const BrickCoord brick : beside) {
      if (find(brick) != nullptr) continue;
      owners.push_back(
          {brick, owns_corner(brick) || may_hold(brick), mask_in(before_, before_.leaf, brick),
           before_.refined.empty() ? BrickMask{} : mask_in(before_, before_.refined, brick)});
    }
    for (PatchedBrick& now : patched_) now.is_there = now.is_there || owns_corner(now.brick);
    patched_.insert(patched_.end(), owners.begin(), owners.end());
    std::ranges::sort(patched_, {}, &PatchedBrick::brick);
  }

  const OctreeLevel& before_;
  std::vector<PatchedBrick> patched_;
};

OctreeLevel patch_finest(const FinestCells& finest, const EarlierTree& earlier) {
  const OctreeLevel& before = earlier.tree.levels[0];
  std::vector<PatchedBrick> patched;
  for (const BrickCoord brick : earlier.changed) {
    const BrickMask* const cells = find_cells(finest, brick);
    // One without any cell may have been there, or not, for the corners that it owned.
    const std::uint32_t at = before.index.find(brick);
    const bool was_there = at != kNoBrick;
    if (cells == nullptr ? !was_there : was_there && *cells == before.leaf[at]) continue;
    patched.push_back(
        {brick, cells != nullptr, cells != nullptr ? *cells : BrickMask{}, BrickMask{}});
  }
  const auto may_hold = [&](BrickCoord brick) { return find_cells(finest, brick) != nullptr; };
  return LevelPatch(before, std::move(patched), may_hold).make();
}

/// A level above the finest and below the largest; `above` are the cells that are divided in
/// the level above it.
OctreeLevel patch_level(int level,
                        const EarlierTree& earlier,
                        const RefinedPatch& refined,
                        const RefinedPatch& above,
                        const OctreeSpace& space,
                        const Cancellation& cancellation) {
  Bricks bricks = refined.changed.bricks;
  for (const BrickCoord parent : above.changed.bricks) add_bricks_below(parent, bricks);
  for (const BrickCoord finest : earlier.changed) bricks.push_back(brick_above(finest, level));
  sort_unique(bricks);
  const auto candidates_of = [&](BrickCoord brick) {
    return children_within(above.of(brick_above(brick)), brick);
  };
  std::vector<PatchedBrick> patched(bricks.size());
  for_each_range(bricks.size(), kPatchedPerRange, [&](std::size_t begin, std::size_t end) {
    PhiSampler sampler(space.field);
    for (std::size_t i = begin; i < end && !cancellation.requested(); ++i) {
      const BrickMask candidates = candidates_of(bricks[i]);
      const BrickMask divided = refined.of(bricks[i]);
      patched[i] = {
          bricks[i], candidates.any(),
          inside_cells(sampler, space.is_inside, bricks[i], level, candidates & ~divided),
          divided};
    }
  });
  const auto may_hold = [&](BrickCoord brick) { return candidates_of(brick).any(); };
  return LevelPatch(earlier.tree.levels[static_cast<std::size_t>(level)], std::move(patched),
                    may_hold)
      .make();
}

}  // namespace

bool can_patch(const EarlierTree& earlier,
               const FinestCells& finest,
               const OctreeSpace& space) {
  return earlier.tree.follows_surface && earlier.tree.levels.size() > 1 &&
         space.rules.max_levels > 0 && !space.rules.sized() && !space.cover.domain &&
         earlier.changed.size() < finest.bricks.size() / kLeastUnchanged;
}

Octree patch_tree(const FinestCells& finest,
                  const EarlierTree& earlier,
                  const OctreeSpace& space,
                  const Cancellation& cancellation) {
  const std::vector<OctreeLevel>& before = earlier.tree.levels;
  Octree tree;
  tree.follows_surface = true;
  tree.levels.push_back(patch_finest(finest, earlier));
  RefinedPatch refined = first_patch(before[1], finest, earlier.changed, cancellation);
  int level = 1;
  for (; level < space.rules.max_levels && !cancellation.requested(); ++level) {
    const auto next = static_cast<std::size_t>(level) + 1;
    const OctreeLevel& next_before = next < before.size() ? before[next] : earlier.tree.above;
    if (next > before.size() || next_before.bricks.empty()) break;
    RefinedPatch above = patch_above(refined, next_before, cancellation);
    OctreeLevel made = patch_level(level, earlier, refined, above, space, cancellation);
    if (!any_leaf(made)) return tree;  // and so does no level above it
    tree.levels.push_back(std::move(made));
    refined = std::move(above);
  }
  if (cancellation.requested()) return tree;
  const auto patched = tree.levels.size();
  add_levels(tree, level, refined.all(), space, cancellation);
  for (std::size_t l = patched; l < tree.levels.size(); ++l) {
    insert_corner_bricks(tree.levels[l]);
  }
  return tree;
}

}  // namespace tet
