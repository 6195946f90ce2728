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

std::optional<std::vector<KeptOfBrick>> find_kept_of_bricks(const ComparedMesh& earlier,
                                                            const ComparedMesh& now,
                                                            int level,
                                                            const KeptBricks& kept,
                                                            PatchDetail detail,
                                                            std::size_t most_runs,
                                                            const Cancellation& cancellation) {
  const bool by_slices = detail == PatchDetail::kSlices && level == 0;
  std::vector<KeptOfBrick> parts;
  for (std::size_t i = 0; i < kept.vertices.size(); ++i) {
    const std::uint32_t before = place_before(kept, i);
    if (before == kNewBrick || kept.tets[i] != kNewBrick) continue;
    if (kept.vertices[i] == kNewBrick || by_slices) parts.push_back({i, before, {}, {}, {}});
  }
  // The first run of a brick's vertices, and of its tets, may go on with the last of another's.
  const std::size_t too_many = most_runs + 2 * parts.size();
  std::atomic<std::size_t> runs{0};
  const auto is_over = [&] {
    return runs.load(std::memory_order_relaxed) > too_many || cancellation.requested();
  };
  for_each_range(parts.size(), kPartsPerRange, [&](std::size_t begin, std::size_t end) {
    VertexComparison vertices(earlier, now, level, PatchDetail::kBricks);
    const TetComparison tets(earlier, now);
    for (std::size_t k = begin; k < end && !is_over(); ++k) {
      KeptOfBrick& part = parts[k];
      const auto [brick, before] = std::pair(part.brick, part.before);
      BrickMask cells;
      if (level == 0) cells = tets.kept_cells(before, brick, kept.read.of(brick));
      if (kept.vertices[brick] == kNewBrick) {
        vertices.look_at(before, brick);
        vertices.add_runs(cells, part.vertices);
      }
      if (by_slices) {
        part.new_cells = ~cells;
        if (cells.any()) tets.add_runs(before, brick, cells, part.tets);
      }
      runs.fetch_add(part.vertices.size() + part.tets.size(), std::memory_order_relaxed);
    }
  });
  if (is_over()) return std::nullopt;
  return parts;
}

}  // namespace tet
