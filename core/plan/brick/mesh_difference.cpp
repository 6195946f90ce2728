#include "core/plan/brick/mesh_difference.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <memory>
#include <span>
#include <utility>

#include "core/base/parallel.h"
#include "core/plan/brick/changed_reach.h"
#include "core/plan/brick/survey.h"
#include "core/plan/brick/unchanged_bricks.h"
#include "core/stuffing/brick_geometry.h"

namespace tet {
namespace {

constexpr std::size_t kComparedPerRange = 64;

/// Packed geometry of one brick after another, found again where it was not kept.
class Geometry {
 public:
  explicit Geometry(const ComparedMesh& of)
      : of_(of), sampler_(of.field), workspace_(nullptr) {}

  std::span<const std::byte> of_brick(std::size_t brick) {
    const Survey& survey = of_.mesh.survey();
    const std::uint32_t at = of_.mesh.stuffed(brick);
    const StuffedBrick& stuffed = survey.stuffed[at];
    const std::size_t size = GeometrySizes(stuffed).bytes();
    if (const std::byte* kept = survey.geometry.of_brick[at]) return {kept, size};
    if (workspace_ == nullptr) {
      workspace_ = std::make_unique_for_overwrite<StuffingWorkspace>();
      packed_.resize(kMaxGeometryBytes);
    }
    stuff_brick(sampler_, of_.mesh.tree().levels[0].bricks[brick], of_.mesh.rules(),
                of_.mesh.restored(), *workspace_);
    pack_geometry(workspace_->lattice, stuffed, packed_.data());
    return {packed_.data(), size};
  }

 private:
  const ComparedMesh& of_;
  PhiSampler sampler_;
  std::unique_ptr<StuffingWorkspace> workspace_;
  std::vector<std::byte> packed_;
};

bool same_signs(const StuffedBrick& a, const StuffedBrick& b) {
  return a.plus == b.plus && a.zero == b.zero && a.cut == b.cut;
}

/// Tells bricks of one level from those that they were.
class LevelComparison {
 public:
  LevelComparison(const ComparedMesh& earlier, const ComparedMesh& now, int level)
      : level_(level),
        earlier_(earlier),
        now_(now),
        geometry_before_(earlier),
        geometry_(now) {}

  /// Whether its leaves are, and the vertices that it owns, and where they lie.
  bool is_same(std::size_t before, std::size_t brick) {
    if (!same_cells(tree_level(earlier_), before, tree_level(now_), brick)) return false;
    const LevelNodes& nodes_before = earlier_.mesh.nodes(level_);
    const LevelNodes& nodes = now_.mesh.nodes(level_);
    return nodes_before.corner[before] == nodes.corner[brick] &&
           nodes_before.centre[before] == nodes.centre[brick] &&
           (level_ > 0 || same_surface(before, brick));
  }

 private:
  const OctreeLevel& tree_level(const ComparedMesh& of) const {
    return of.mesh.tree().levels[static_cast<std::size_t>(level_)];
  }

  bool same_surface(std::size_t before, std::size_t brick) {
    const std::uint32_t a = earlier_.mesh.stuffed(before), b = now_.mesh.stuffed(brick);
    if (a >= kAllInside || b >= kAllInside) return a == b;
    const Survey& survey_before = earlier_.mesh.survey();
    const Survey& survey = now_.mesh.survey();
    if (!survey.known.empty() && survey.known[b] == a) return true;
    if (!same_signs(survey_before.stuffed[a], survey.stuffed[b])) return false;
    if (!survey.fans.empty() && survey_before.fans[a] != survey.fans[b]) return false;
    return std::ranges::equal(geometry_before_.of_brick(before), geometry_.of_brick(brick));
  }

  int level_;
  const ComparedMesh& earlier_;
  const ComparedMesh& now_;
  Geometry geometry_before_, geometry_;
};

/// Cells that a level divides otherwise than it did; a level without the brick has nothing
/// there.
BrickMask changed_cells(const OctreeLevel* before,
                        std::size_t at_before,
                        const OctreeLevel* now,
                        std::size_t at) noexcept {
  BrickMask cells;
  const auto add = [&](const MaskColumn OctreeLevel::*masks) {
    const BrickMask a = before != nullptr && !(before->*masks).empty()
                            ? (before->*masks)[at_before]
                            : BrickMask{};
    const BrickMask b =
        now != nullptr && !(now->*masks).empty() ? (now->*masks)[at] : BrickMask{};
    cells |= (a | b) & ~(a & b);
  };
  add(&OctreeLevel::leaf);
  add(&OctreeLevel::refined);
  return cells;
}

/// What a brick owns.
struct OwnedNodes {
  BrickMask corner, centre, cut;
  /// kAllInside or kAllOutside; else they are moved, or cut, and have places of their own.
  std::uint32_t side = kAllInside;

  bool keeps_places(const OwnedNodes& now) const noexcept {
    return side == now.side && side >= kAllInside;
  }
};

OwnedNodes nodes_of(const CountedMesh& mesh, int level, std::size_t brick) {
  const LevelNodes& nodes = mesh.nodes(level);
  OwnedNodes owned{nodes.corner[brick], nodes.centre[brick], {}};
  if (level > 0) return owned;
  owned.side = mesh.stuffed(brick);
  if (owned.side >= kAllInside) return owned;
  for (const BrickMask& cut : mesh.survey().stuffed[mesh.stuffed(brick)].cut) owned.cut |= cut;
  return owned;
}

BrickMask either(const BrickMask& a, const BrickMask& b) { return (a | b) & ~(a & b); }

/// A brick that is not as it was, from what it owned and owns now. Nodes in their lattice
/// places are kept where they were there before: only the others are changed.
ChangedBrick changed_brick(BrickCoord brick,
                           const BrickMask& cells,
                           const OwnedNodes& before,
                           const OwnedNodes& now) {
  const BrickMask corners = either(before.corner, now.corner);
  if (before.keeps_places(now)) {
    return {brick, cells, corners, corners | either(before.centre, now.centre)};
  }
  return {brick, cells, before.corner | now.corner,
          before.corner | now.corner | before.centre | now.centre | before.cut | now.cut};
}

/// Finds the number of each brick in the earlier level where the brick is as it was, else
/// kNewBrick; `same` has some of them, or is empty. `changed` gets the bricks that only one
/// level has, and those that differ; and `partly_same` the earlier numbers of the latter.
BrickPlaces find_same(const ComparedMesh& earlier,
                      const ComparedMesh& now,
                      int level,
                      BrickPlaces same,
                      std::vector<ChangedBrick>& changed,
                      BrickPlaces& partly_same) {
  const auto l = static_cast<std::size_t>(level);
  static const std::vector<BrickCoord> none;
  const auto& levels_before = earlier.mesh.tree().levels;
  const OctreeLevel* const level_before =
      l < levels_before.size() ? &levels_before[l] : nullptr;
  const std::vector<BrickCoord>& before = level_before ? level_before->bricks : none;
  const OctreeLevel& level_now = now.mesh.tree().levels[l];
  const std::vector<BrickCoord>& bricks = level_now.bricks;
  same.resize(bricks.size(), kNewBrick);
  partly_same.assign(bricks.size(), kNewBrick);
  for_each_range(bricks.size(), kComparedPerRange, [&](std::size_t begin, std::size_t end) {
    while (begin < end && same[begin] != kNewBrick) ++begin;
    if (begin == end) return;
    LevelComparison comparison(earlier, now, level);
    auto at = std::ranges::lower_bound(before, bricks[begin]);
    for (std::size_t i = begin; i < end; ++i) {
      if (same[i] != kNewBrick) continue;
      while (at != before.end() && *at < bricks[i]) ++at;
      if (at == before.end() || *at != bricks[i]) continue;
      const auto number = static_cast<std::size_t>(at - before.begin());
      if (comparison.is_same(number, i)) same[i] = static_cast<std::uint32_t>(number);
    }
  });
  std::size_t at = 0;
  const auto vanish_below = [&](const BrickCoord* brick) {
    for (; at < before.size() && (brick == nullptr || before[at] < *brick); ++at) {
      changed.push_back(changed_brick(before[at], changed_cells(level_before, at, nullptr, 0),
                                      nodes_of(earlier.mesh, level, at), {}));
    }
  };
  for (std::size_t i = 0; i < bricks.size(); ++i) {
    vanish_below(&bricks[i]);
    const bool was_there = at < before.size() && before[at] == bricks[i];
    if (same[i] == kNewBrick) {
      const OctreeLevel* const then = was_there ? level_before : nullptr;
      const OwnedNodes had = was_there ? nodes_of(earlier.mesh, level, at) : OwnedNodes{};
      changed.push_back(changed_brick(bricks[i], changed_cells(then, at, &level_now, i), had,
                                      nodes_of(now.mesh, level, i)));
      if (was_there) partly_same[i] = static_cast<std::uint32_t>(at);
    }
    at += was_there;
  }
  vanish_below(nullptr);
  return same;
}

void add_run(std::vector<KeptRun>& runs, const KeptRun& run) {
  if (run.count == 0) return;
  if (!runs.empty()) {
    KeptRun& last = runs.back();
    if (last.from + last.count == run.from && last.to + last.count == run.to) {
      last.count += run.count;
      return;
    }
  }
  runs.push_back(run);
}

/// Adds the nodes that a brick has as it had them, where neither is at the surface.
void add_nodes(const ComparedMesh& earlier,
               const ComparedMesh& now,
               int level,
               std::size_t before,
               std::size_t brick,
               std::vector<KeptRun>& runs) {
  const OwnedNodes had = nodes_of(earlier.mesh, level, before);
  const OwnedNodes has = nodes_of(now.mesh, level, brick);
  if (!had.keeps_places(has)) return;
  std::uint64_t from = earlier.mesh.first_vertex(earlier.mesh.first_brick(level) + before);
  std::uint64_t to = now.mesh.first_vertex(now.mesh.first_brick(level) + brick);
  for (const auto& [a, b] :
       {std::pair(had.corner, has.corner), std::pair(had.centre, has.centre)}) {
    for (std::size_t x = 0; x < a.slice.size(); ++x) {
      for (std::uint64_t rest = a.slice[x] | b.slice[x]; rest != 0; rest &= rest - 1) {
        const bool was = (a.slice[x] & rest & (~rest + 1)) != 0;
        const bool is = (b.slice[x] & rest & (~rest + 1)) != 0;
        if (was && is) add_run(runs, {from, to, 1});
        from += was;
        to += is;
      }
    }
  }
}

/// Adds a level's bricks to what is kept or changed, in the order of ids.
void add_level(const ComparedMesh& earlier,
               const ComparedMesh& now,
               int level,
               const KeptBricks& kept,
               MeshDifference& difference) {
  const std::size_t first = now.mesh.first_brick(level);
  for (std::size_t i = 0; i < kept.vertices.size(); ++i) {
    const std::size_t brick = first + i;
    if (kept.vertices[i] != kNewBrick) {
      const std::size_t before = earlier.mesh.first_brick(level) + kept.vertices[i];
      add_run(difference.kept.vertices,
              {earlier.mesh.first_vertex(before), now.mesh.first_vertex(brick),
               now.mesh.first_vertex(brick + 1) - now.mesh.first_vertex(brick)});
    } else if (kept.nodes[i] != kNewBrick) {
      add_nodes(earlier, now, level, kept.nodes[i], i, difference.kept.vertices);
    }
    if (kept.tets[i] != kNewBrick) {
      const std::size_t before = earlier.mesh.first_brick(level) + kept.tets[i];
      add_run(difference.kept.tets,
              {earlier.mesh.first_tet(before), now.mesh.first_tet(brick),
               now.mesh.first_tet(brick + 1) - now.mesh.first_tet(brick)});
      continue;
    }
    auto& changed = difference.changed;
    if (!changed.empty() && changed.back().end == brick) {
      ++changed.back().end;
    } else {
      changed.push_back({brick, brick + 1});
    }
  }
}

}  // namespace

std::vector<KeptBricks> find_kept_bricks(const ComparedMesh& earlier,
                                         const ComparedMesh& now,
                                         std::vector<BrickPlaces> unchanged) {
  unchanged.resize(now.mesh.tree().levels.size());
  std::vector<KeptBricks> kept;
  std::vector<std::vector<ChangedBrick>> changed;
  for (int level = 0; level < static_cast<int>(now.mesh.tree().levels.size()); ++level) {
    KeptBricks level_kept;
    level_kept.vertices =
        find_same(earlier, now, level, std::move(unchanged[static_cast<std::size_t>(level)]),
                  changed.emplace_back(), level_kept.nodes);
    level_kept.tets = level_kept.vertices;
    mark_readers(changed, now.mesh.tree().levels[static_cast<std::size_t>(level)],
                 level_kept.tets);
    kept.push_back(std::move(level_kept));
  }
  return kept;
}

MeshDifference compare_meshes(const ComparedMesh& earlier, const ComparedMesh& now) {
  MeshDifference difference;
  std::vector<KeptBricks> found;
  const std::vector<KeptBricks>* known = now.mesh.kept_of(earlier.mesh);
  if (known == nullptr) found = find_kept_bricks(earlier, now);
  const std::vector<KeptBricks>& kept = known != nullptr ? *known : found;
  for (std::size_t level = 0; level < kept.size(); ++level) {
    add_level(earlier, now, static_cast<int>(level), kept[level], difference);
  }
  return difference;
}

}  // namespace tet
