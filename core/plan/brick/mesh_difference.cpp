#include "core/plan/brick/mesh_difference.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <memory>
#include <span>
#include <utility>

#include "core/base/brick_sets.h"
#include "core/base/parallel.h"
#include "core/plan/brick/survey.h"
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

/// What of a brick is not as it was.
enum class Change : std::uint8_t {
  kNone,
  kVertices,  ///< which it owns, or where they lie
  kLeaves,    ///< or cells refined, or inside: what bricks on all sides of it look at
};

/// Tells bricks of one level from those that they were.
class LevelComparison {
 public:
  LevelComparison(const ComparedMesh& earlier, const ComparedMesh& now, int level)
      : level_(level),
        earlier_(earlier),
        now_(now),
        geometry_before_(earlier),
        geometry_(now) {}

  Change change(std::size_t before, std::size_t brick) {
    if (!same_cells(before, brick)) return Change::kLeaves;
    const LevelNodes& nodes_before = earlier_.mesh.nodes(level_);
    const LevelNodes& nodes = now_.mesh.nodes(level_);
    const bool same_nodes = nodes_before.corner[before] == nodes.corner[brick] &&
                            nodes_before.centre[before] == nodes.centre[brick];
    if (!same_nodes || (level_ == 0 && !same_surface(before, brick))) return Change::kVertices;
    return Change::kNone;
  }

 private:
  const OctreeLevel& tree_level(const ComparedMesh& of) const {
    return of.mesh.tree().levels[static_cast<std::size_t>(level_)];
  }

  bool same_cells(std::size_t before, std::size_t brick) const {
    const OctreeLevel& a = tree_level(earlier_);
    const OctreeLevel& b = tree_level(now_);
    if (!(a.leaf[before] == b.leaf[brick])) return false;
    if (level_ == 0) return true;
    const bool same_inside = a.inside.empty() == b.inside.empty() &&
                             (a.inside.empty() || a.inside[before] == b.inside[brick]);
    return same_inside && a.refined[before] == b.refined[brick];
  }

  bool same_surface(std::size_t before, std::size_t brick) {
    const std::uint32_t a = earlier_.mesh.stuffed(before), b = now_.mesh.stuffed(brick);
    if (a >= kAllInside || b >= kAllInside) return a == b;
    const Survey& survey_before = earlier_.mesh.survey();
    const Survey& survey = now_.mesh.survey();
    if (!same_signs(survey_before.stuffed[a], survey.stuffed[b])) return false;
    if (!survey.fans.empty() && survey_before.fans[a] != survey.fans[b]) return false;
    return std::ranges::equal(geometry_before_.of_brick(before), geometry_.of_brick(brick));
  }

  int level_;
  const ComparedMesh& earlier_;
  const ComparedMesh& now_;
  Geometry geometry_before_, geometry_;
};

/// Bricks of a level that are not as they were.
struct ChangedBricks {
  std::vector<BrickCoord> vertices, leaves;

  void add(BrickCoord brick, Change change) {
    if (change == Change::kVertices) vertices.push_back(brick);
    if (change == Change::kLeaves) leaves.push_back(brick);
  }

  /// Tets have nodes of finer levels, where those have leaves.
  void add_parents(const ChangedBricks& finer) {
    const auto parent = [](BrickCoord b) { return BrickCoord{b.x >> 1, b.y >> 1, b.z >> 1}; };
    std::ranges::transform(finer.vertices, std::back_inserter(vertices), parent);
    std::ranges::transform(finer.leaves, std::back_inserter(leaves), parent);
    sort_unique(vertices);
    sort_unique(leaves);
  }

  /// Bricks whose tets may be others: they read cells of all 26 bricks around, and vertices of
  /// the upper ones. Sorted, unique.
  std::vector<BrickCoord> readers() const {
    std::vector<BrickCoord> bricks = with_neighbours(leaves);
    for (const BrickCoord b : vertices) {
      for_each_brick({{b.x - 1, b.y - 1, b.z - 1}, b},
                     [&](BrickCoord brick) { bricks.push_back(brick); });
    }
    sort_unique(bricks);
    return bricks;
  }
};

/// Finds the number of each brick in the earlier level where the brick is as it was, else
/// kNewBrick. `changed` gets the bricks that only one level has, and those that differ.
std::vector<std::uint32_t> find_same(const ComparedMesh& earlier,
                                     const ComparedMesh& now,
                                     int level,
                                     ChangedBricks& changed) {
  const auto l = static_cast<std::size_t>(level);
  static const std::vector<BrickCoord> kNone;
  const auto& levels_before = earlier.mesh.tree().levels;
  const std::vector<BrickCoord>& before =
      l < levels_before.size() ? levels_before[l].bricks : kNone;
  const std::vector<BrickCoord>& bricks = now.mesh.tree().levels[l].bricks;
  std::vector<std::uint32_t> same(bricks.size(), kNewBrick);
  std::vector<Change> change(bricks.size(), Change::kNone);
  std::ranges::set_symmetric_difference(before, bricks, std::back_inserter(changed.leaves));
  for_each_range(bricks.size(), kComparedPerRange, [&](std::size_t begin, std::size_t end) {
    LevelComparison comparison(earlier, now, level);
    auto at = std::ranges::lower_bound(before, bricks[begin]);
    for (std::size_t i = begin; i < end; ++i) {
      while (at != before.end() && *at < bricks[i]) ++at;
      if (at == before.end() || *at != bricks[i]) continue;
      const auto number = static_cast<std::size_t>(at - before.begin());
      change[i] = comparison.change(number, i);
      if (change[i] == Change::kNone) same[i] = static_cast<std::uint32_t>(number);
    }
  });
  for (std::size_t i = 0; i < bricks.size(); ++i) changed.add(bricks[i], change[i]);
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

/// Keeps the bricks of `same` that are not among the sorted `touched`.
std::vector<std::uint32_t> untouched(std::span<const std::uint32_t> same,
                                     const std::vector<BrickCoord>& bricks,
                                     const std::vector<BrickCoord>& touched) {
  std::vector<std::uint32_t> rest(same.begin(), same.end());
  auto at = touched.begin();
  for (std::size_t i = 0; i < bricks.size() && at != touched.end(); ++i) {
    while (at != touched.end() && *at < bricks[i]) ++at;
    if (at != touched.end() && *at == bricks[i]) rest[i] = kNewBrick;
  }
  return rest;
}

}  // namespace

std::vector<KeptBricks> find_kept_bricks(const ComparedMesh& earlier, const ComparedMesh& now) {
  std::vector<KeptBricks> kept;
  ChangedBricks finer;
  for (int level = 0; level < static_cast<int>(now.mesh.tree().levels.size()); ++level) {
    ChangedBricks changed;
    std::vector<std::uint32_t> same = find_same(earlier, now, level, changed);
    changed.add_parents(finer);
    const auto& bricks = now.mesh.tree().levels[static_cast<std::size_t>(level)].bricks;
    std::vector<std::uint32_t> same_tets = untouched(same, bricks, changed.readers());
    kept.push_back({std::move(same), std::move(same_tets)});
    finer = std::move(changed);
  }
  return kept;
}

MeshDifference compare_meshes(const ComparedMesh& earlier, const ComparedMesh& now) {
  MeshDifference difference;
  const std::vector<KeptBricks> kept = find_kept_bricks(earlier, now);
  for (std::size_t level = 0; level < kept.size(); ++level) {
    add_level(earlier, now, static_cast<int>(level), kept[level], difference);
  }
  return difference;
}

}  // namespace tet
