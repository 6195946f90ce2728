#include "core/plan/brick/kept_of_bricks.h"

#include <atomic>
#include <cstdint>
#include <utility>

#include "core/base/brick_neighbours.h"
#include "core/base/parallel.h"
#include "core/plan/brick/kept_runs.h"
#include "core/plan/brick/kept_tets.h"
#include "core/plan/brick/vertex_comparison.h"

namespace tet {
namespace {

constexpr std::size_t kPartsPerRange = 64;

/// Where one of a level's bricks was that is not kept as a whole, or kNewBrick.
std::uint32_t place_before(const KeptBricks& kept, std::size_t brick) {
  return kept.vertices[brick] != kNewBrick ? kept.vertices[brick] : kept.nodes[brick];
}

bool keeps_slices(int level, PatchDetail detail) {
  return detail == PatchDetail::kSlices && level == 0;
}

/// What finest bricks keep of their tets.
class TetComparison {
 public:
  TetComparison(const ComparedMesh& earlier, const ComparedMesh& now)
      : earlier_(earlier.mesh), now_(now.mesh) {}

  /// The cells that a brick keeps are leaves as they were, and read nothing that changed; of
  /// each slice all or none. Tets lie shape by shape, and within one slice by slice: cells that
  /// are kept among others would be in three times as many runs, for a fifth fewer tets.
  BrickMask kept_cells(std::size_t before, std::size_t brick, const BrickMask& read) const {
    const BrickMask &had = leaves(earlier_)[before], &has = leaves(now_)[brick];
    BrickMask kept = had & has & ~read & ~other_fans(before, brick);
    for (std::size_t x = 0; x < kept.slice.size(); ++x) {
      if (((had.slice[x] | has.slice[x]) & ~kept.slice[x]) != 0) kept.slice[x] = 0;
    }
    return kept;
  }

  void add_runs(std::size_t before,
                std::size_t brick,
                const BrickMask& cells,
                std::vector<KeptRun>& runs) const {
    TetsOfBrick had = tets_of(earlier_, before), has = tets_of(now_, brick);
    RunWalk walk(earlier_.first_tet(before), now_.first_tet(brick), runs);
    pass_tets(had, has, cells, now_.regions(), walk);
  }

 private:
  BrickMask other_fans(std::size_t before, std::size_t brick) const {
    const FanMasks* const had = earlier_.vertices_of_finest(before).fans;
    const FanMasks* const has = now_.vertices_of_finest(brick).fans;
    BrickMask others;
    if (had == nullptr || has == nullptr) return others;
    for (std::size_t shape = 0; shape < kTetShapes; ++shape) {
      others |= ((*had)[shape] | (*has)[shape]) & ~((*had)[shape] & (*has)[shape]);
    }
    return others;
  }

  static const MaskColumn& leaves(const CountedMesh& mesh) {
    return mesh.tree().levels[0].leaf;
  }

  static TetsOfBrick tets_of(const CountedMesh& mesh, std::size_t brick) {
    const OctreeLevel& level = mesh.tree().levels[0];
    const PlacesAround places = places_around(level.index, level.bricks[brick]);
    return {nodes_around_cells(mesh.neighbourhood(brick), leaves_around(level.leaf, places)),
            mesh.vertices_of_finest(brick).fans};
  }

  const CountedMesh& earlier_;
  const CountedMesh& now_;
};

}  // namespace

std::vector<KeptOfBrick> find_partly_kept(const ComparedPair& meshes,
                                          int level,
                                          const KeptBricks& kept) {
  std::vector<KeptOfBrick> parts;
  for (std::size_t i = 0; i < kept.vertices.size(); ++i) {
    const std::uint32_t before = place_before(kept, i);
    if (before == kNewBrick || kept.tets[i] != kNewBrick) continue;
    if (kept.vertices[i] == kNewBrick || keeps_slices(level, meshes.detail)) {
      parts.push_back({.brick = i, .before = before, .cells = {}, .vertices = {}, .tets = {}});
    }
  }
  if (level > 0) return parts;
  for_each_range(parts.size(), kPartsPerRange, [&](std::size_t begin, std::size_t end) {
    const TetComparison tets(meshes.earlier, meshes.now);
    for (std::size_t k = begin; k < end && !meshes.cancellation.requested(); ++k) {
      KeptOfBrick& part = parts[k];
      part.cells = tets.kept_cells(part.before, part.brick, kept.read.of(part.brick));
    }
  });
  return parts;
}

std::uint64_t most_kept_tets(const ComparedPair& meshes,
                             int level,
                             const KeptBricks& kept,
                             const std::vector<KeptOfBrick>& parts) {
  const CountedMesh& now = meshes.now.mesh;
  const std::size_t first = now.first_brick(level);
  std::uint64_t tets = 0;
  const auto add = [&](std::size_t brick) {
    tets += now.first_tet(first + brick + 1) - now.first_tet(first + brick);
  };
  for (std::size_t i = 0; i < kept.tets.size(); ++i) {
    if (kept.tets[i] != kNewBrick) add(i);
  }
  if (!keeps_slices(level, meshes.detail)) return tets;
  for (const KeptOfBrick& part : parts) {
    if (part.cells.any()) add(part.brick);
  }
  return tets;
}

bool find_kept_runs(const ComparedPair& meshes,
                    int level,
                    const KeptBricks& kept,
                    std::size_t most_runs,
                    std::vector<KeptOfBrick>& parts) {
  // The first run of a brick's vertices, and of its tets, may go on with the last of another's.
  const std::size_t too_many = most_runs + 2 * parts.size();
  std::atomic<std::size_t> runs{0};
  const auto is_over = [&] {
    return runs.load(std::memory_order_relaxed) > too_many || meshes.cancellation.requested();
  };
  for_each_range(parts.size(), kPartsPerRange, [&](std::size_t begin, std::size_t end) {
    VertexComparison vertices(meshes.earlier, meshes.now, level, PatchDetail::kBricks);
    const TetComparison tets(meshes.earlier, meshes.now);
    for (std::size_t k = begin; k < end && !is_over(); ++k) {
      KeptOfBrick& part = parts[k];
      if (kept.vertices[part.brick] == kNewBrick) {
        vertices.look_at(part.before, part.brick);
        vertices.add_runs(part.cells, part.vertices);
      }
      if (keeps_slices(level, meshes.detail) && part.cells.any()) {
        tets.add_runs(part.before, part.brick, part.cells, part.tets);
      }
      runs.fetch_add(part.vertices.size() + part.tets.size(), std::memory_order_relaxed);
    }
  });
  return !is_over();
}

}  // namespace tet
