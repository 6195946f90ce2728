#include "core/plan/brick/mesh_difference.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <span>
#include <utility>

#include "core/base/parallel.h"
#include "core/plan/brick/changed_reach.h"
#include "core/plan/brick/found_geometry.h"
#include "core/plan/brick/kept_of_bricks.h"
#include "core/plan/brick/kept_runs.h"
#include "core/plan/brick/survey.h"
#include "core/plan/brick/unchanged_bricks.h"
#include "core/plan/brick/vertex_comparison.h"

namespace tet {
namespace {

constexpr std::size_t kComparedPerRange = 64;

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
  FoundGeometry geometry_before_, geometry_;
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

/// A brick of one level or of both, by its places there.
struct OtherBrick {
  std::size_t before = kNewBrick, now = kNewBrick;
};

/// Finds the number of each brick in the earlier level where the brick is as it was, else
/// kNewBrick; `same` has some of them, or is empty. `changed` gets the bricks that only one
/// level has, and those that differ; and `partly_same` the earlier numbers of the latter,
/// unless they keep nothing.
BrickPlaces find_same(const ComparedPair& meshes,
                      int level,
                      BrickPlaces same,
                      std::vector<ChangedBrick>& changed,
                      BrickPlaces& partly_same) {
  const ComparedMesh &earlier = meshes.earlier, &now = meshes.now;
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
    for (std::size_t i = begin; i < end && !meshes.cancellation.requested(); ++i) {
      if (same[i] != kNewBrick) continue;
      while (at != before.end() && *at < bricks[i]) ++at;
      if (at == before.end() || *at != bricks[i]) continue;
      const auto number = static_cast<std::size_t>(at - before.begin());
      if (comparison.is_same(number, i)) same[i] = static_cast<std::uint32_t>(number);
    }
  });
  std::size_t at = 0;
  std::vector<OtherBrick> others;
  const auto vanish_below = [&](const BrickCoord* brick) {
    for (; at < before.size() && (brick == nullptr || before[at] < *brick); ++at) {
      others.push_back({at, kNewBrick});
    }
  };
  for (std::size_t i = 0; i < bricks.size(); ++i) {
    vanish_below(&bricks[i]);
    const bool was_there = at < before.size() && before[at] == bricks[i];
    if (same[i] == kNewBrick) {
      others.push_back({was_there ? at : kNewBrick, i});
      if (was_there && meshes.detail != PatchDetail::kWhole)
        partly_same[i] = static_cast<std::uint32_t>(at);
    }
    at += was_there;
  }
  vanish_below(nullptr);
  changed.resize(others.size());
  for_each_range(others.size(), kComparedPerRange, [&](std::size_t begin, std::size_t end) {
    VertexComparison comparison(earlier, now, level, meshes.detail);
    for (std::size_t i = begin; i < end && !meshes.cancellation.requested(); ++i) {
      const auto [then, here] = others[i];
      comparison.look_at(then, here);
      const BrickMask cells = changed_cells(then == kNewBrick ? nullptr : level_before, then,
                                            here == kNewBrick ? nullptr : &level_now, here);
      changed[i] = comparison.changed(here == kNewBrick ? before[then] : bricks[here], cells);
    }
  });
  return same;
}

/// Middles of surface quads lie between cut points of other bricks, too.
void leave_out_moved_quads(const CountedMesh& mesh, KeptBricks& kept) {
  if (mesh.survey().fans.empty()) return;
  for (std::size_t i = 0; i < kept.vertices.size(); ++i) {
    if (kept.vertices[i] == kNewBrick || kept.tets[i] != kNewBrick) continue;
    const FanMasks* const fans = mesh.vertices_of_finest(i).fans;
    const BrickMask read = kept.read.of(i);
    if (fans == nullptr ||
        std::ranges::none_of(*fans, [&](const BrickMask& fan) { return (fan & read).any(); })) {
      continue;
    }
    kept.nodes[i] = std::exchange(kept.vertices[i], kNewBrick);
  }
}

/// Adds a level's bricks to what is kept or changed, in the order of ids.
void add_level(const ComparedMesh& earlier,
               const ComparedMesh& now,
               int level,
               const KeptBricks& kept,
               const std::vector<KeptOfBrick>& parts,
               MeshDifference& difference) {
  const std::size_t first = now.mesh.first_brick(level);
  auto part = parts.begin();
  for (std::size_t i = 0; i < kept.vertices.size(); ++i) {
    const std::size_t brick = first + i;
    const bool has_part = part != parts.end() && part->brick == i;
    if (kept.vertices[i] != kNewBrick) {
      const std::size_t before = earlier.mesh.first_brick(level) + kept.vertices[i];
      add_run(difference.kept.vertices,
              {earlier.mesh.first_vertex(before), now.mesh.first_vertex(brick),
               now.mesh.first_vertex(brick + 1) - now.mesh.first_vertex(brick)});
    } else if (has_part) {
      for (const KeptRun& run : part->vertices) add_run(difference.kept.vertices, run);
    }
    if (kept.tets[i] != kNewBrick) {
      const std::size_t before = earlier.mesh.first_brick(level) + kept.tets[i];
      add_run(difference.kept.tets,
              {earlier.mesh.first_tet(before), now.mesh.first_tet(brick),
               now.mesh.first_tet(brick + 1) - now.mesh.first_tet(brick)});
      continue;
    }
    if (has_part && !part->tets.empty()) {
      for (const KeptRun& run : part->tets) add_run(difference.kept.tets, run);
      difference.partly.push_back({brick, ~part->cells});
    }
    part += has_part ? 1 : 0;
    auto& changed = difference.changed;
    if (!changed.empty() && changed.back().end == brick) {
      ++changed.back().end;
    } else {
      changed.push_back({brick, brick + 1});
    }
  }
}

enum class Outcome : std::uint8_t { kFound, kManyRuns, kOfNoUse };

bool keeps_too_little(const CountedMesh& mesh, std::uint64_t tets, const PatchLimits& limits) {
  const std::uint64_t all = mesh.first_tet(mesh.brick_count());
  return limits.least_kept > 0 && tets < all / limits.least_kept;
}

/// `found` is where it is not known what is kept.
const std::vector<KeptBricks>& kept_of(const ComparedPair& meshes,
                                       std::vector<KeptBricks>& found) {
  const std::vector<KeptBricks>* const known =
      meshes.detail == PatchDetail::kWhole ? nullptr
                                           : meshes.now.mesh.kept_of(meshes.earlier.mesh);
  if (known != nullptr) return *known;
  return found = find_kept_bricks(meshes, {});
}

Outcome find_difference(const ComparedPair& meshes,
                        const PatchLimits& limits,
                        MeshDifference& difference) {
  std::vector<KeptBricks> found;
  const std::vector<KeptBricks>& kept = kept_of(meshes, found);
  if (meshes.cancellation.requested()) return Outcome::kOfNoUse;
  std::vector<std::vector<KeptOfBrick>> parts;
  std::uint64_t most = 0;
  for (std::size_t l = 0; l < kept.size(); ++l) {
    const int level = static_cast<int>(l);
    parts.push_back(find_partly_kept(meshes, level, kept[l]));
    most += most_kept_tets(meshes, level, kept[l], parts.back());
  }
  // Before runs are looked for.
  if (keeps_too_little(meshes.now.mesh, most, limits)) return Outcome::kOfNoUse;
  difference = {};
  difference.kept.loose = meshes.detail == PatchDetail::kSlices;
  for (std::size_t l = 0; l < kept.size(); ++l) {
    const int level = static_cast<int>(l);
    if (!find_kept_runs(meshes, level, kept[l], limits.most_runs, parts[l])) {
      return meshes.cancellation.requested() ? Outcome::kOfNoUse : Outcome::kManyRuns;
    }
    add_level(meshes.earlier, meshes.now, level, kept[l], parts[l], difference);
    parts[l] = {};
    if (difference.kept.vertices.size() + difference.kept.tets.size() > limits.most_runs) {
      return Outcome::kManyRuns;
    }
  }
  std::uint64_t tets = 0;
  for (const KeptRun& run : difference.kept.tets) tets += run.count;
  return keeps_too_little(meshes.now.mesh, tets, limits) ? Outcome::kOfNoUse : Outcome::kFound;
}

}  // namespace

std::vector<KeptBricks> find_kept_bricks(const ComparedPair& meshes,
                                         std::vector<BrickPlaces> unchanged) {
  const ComparedMesh& now = meshes.now;
  unchanged.resize(now.mesh.tree().levels.size());
  std::vector<KeptBricks> kept;
  std::vector<std::vector<ChangedBrick>> changed;
  for (int level = 0; level < static_cast<int>(now.mesh.tree().levels.size()); ++level) {
    KeptBricks level_kept;
    level_kept.vertices =
        find_same(meshes, level, std::move(unchanged[static_cast<std::size_t>(level)]),
                  changed.emplace_back(), level_kept.nodes);
    if (meshes.cancellation.requested()) break;
    level_kept.tets = level_kept.vertices;
    const OctreeLevel& tree_level = now.mesh.tree().levels[static_cast<std::size_t>(level)];
    if (level == 0) level_kept.read = ReadCells(tree_level.bricks.size());
    mark_readers(changed, tree_level, level_kept.tets, level == 0 ? &level_kept.read : nullptr);
    if (level == 0) leave_out_moved_quads(now.mesh, level_kept);
    kept.push_back(std::move(level_kept));
  }
  return kept;
}

std::optional<MeshDifference> compare_meshes(const ComparedPair& meshes,
                                             const PatchLimits& limits) {
  MeshDifference difference;
  Outcome outcome = find_difference(meshes, limits, difference);
  if (outcome == Outcome::kManyRuns) {
    const ComparedPair coarsely{meshes.earlier, meshes.now, PatchDetail::kWhole,
                                meshes.cancellation};
    outcome = find_difference(coarsely, limits, difference);
  }
  if (outcome != Outcome::kFound) return std::nullopt;
  return difference;
}

}  // namespace tet
