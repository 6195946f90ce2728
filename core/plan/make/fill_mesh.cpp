#include "core/plan/make/fill_mesh.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <utility>
#include <vector>

#include "core/base/parallel.h"
#include "core/base/scratch_pool.h"
#include "core/plan/brick/brick_plan.h"
#include "core/plan/brick/fill_brick.h"
#include "core/plan/fill_watch.h"
#include "core/plan/mesh_workspace.h"

namespace tet {
namespace {

QualityStats sum_of(const std::vector<QualityStats>& chunks) {
  QualityStats sum;
  for (const QualityStats& chunk : chunks) sum.add(chunk);
  return sum;
}

/// What one thread fills at a time: a run of a chunk's bricks where a chunk is made of bricks
/// alone, and a chunk otherwise. There are often few chunks for many threads.
struct PartOfChunk {
  std::uint64_t chunk = 0;
  BrickRange bricks = {};
};

/// Fills a mesh part by part.
class PartFiller {
 public:
  PartFiller(const MeshPlan& plan, TetMesh& mesh)
      : plan_(plan),
        bricks_(mesh.header.fields.empty() ? as_bricks(plan) : nullptr),
        mesh_(mesh) {}

  std::vector<PartOfChunk> parts() const {
    std::vector<PartOfChunk> parts;
    for (std::uint64_t chunk = 0; chunk < plan_.header().chunk_count; ++chunk) {
      bricks_ == nullptr ? parts.push_back({chunk}) : add_runs(chunk, parts);
    }
    return parts;
  }

  QualityStats fill(const PartOfChunk& part, MeshWorkspace& workspace) {
    if (bricks_ == nullptr) {
      return plan_.fill_chunk(part.chunk, workspace, mesh_.columns_of(plan_.chunk(part.chunk)));
    }
    return bricks_->fill_bricks(part.bricks, workspace,
                                mesh_.columns_of(bricks_->bricks(part.bricks)));
  }

 private:
  void add_runs(std::uint64_t chunk, std::vector<PartOfChunk>& parts) const {
    const auto [begin, end] = bricks_->bricks_of_chunk(chunk);
    for (std::size_t brick = begin; brick < end; brick += kBricksPerRun) {
      parts.push_back({chunk, {brick, std::min(end, brick + kBricksPerRun)}});
    }
  }

  const MeshPlan& plan_;
  const BrickPlan* const bricks_;  // null where chunks are filled whole
  TetMesh& mesh_;
};

/// The sums of chunks, as each says of itself, one after the other.
QualityStats sum_of(const std::vector<PartOfChunk>& parts,
                    const std::vector<QualityStats>& stats) {
  QualityStats sum, of_chunk;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    of_chunk.add(stats[i]);
    if (i + 1 < parts.size() && parts[i + 1].chunk == parts[i].chunk) continue;
    sum.add(std::exchange(of_chunk, {}));
  }
  return sum;
}

}  // namespace

absl::StatusOr<FilledMesh> fill_mesh(const MeshPlan& plan,
                                     const Cancellation& cancellation,
                                     const ProgressFunction& progress,
                                     TetMesh used,
                                     FieldValues fields) {
  MeshHeader header = plan.header();
  if (fields == FieldValues::kLater) header.fields.clear();
  TetMesh mesh(header, std::move(used));
  PartFiller filler(plan, mesh);
  const std::vector<PartOfChunk> parts = filler.parts();
  std::vector<QualityStats> stats(parts.size());
  ScratchPool<MeshWorkspace> workspaces;
  std::atomic<std::uint64_t> done{0};
  for_each_range(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
    ScratchPool<MeshWorkspace>::Turn workspace(workspaces);
    const WatchedFill watched(*workspace, cancellation);
    for (std::size_t i = begin; i < end && !cancellation.requested(); ++i) {
      stats[i] = filler.fill(parts[i], *workspace);
      if (progress) progress(static_cast<double>(++done) / static_cast<double>(parts.size()));
    }
  });
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  return FilledMesh{std::move(mesh), sum_of(parts, stats)};
}

QualityStats measure_chunks(const MeshPlan& plan, const TetMesh& mesh) {
  std::vector<QualityStats> stats(plan.header().chunk_count);
  for_each_index(stats.size(), [&](std::size_t i) {
    const ChunkExtent extent = plan.chunk(i);
    const std::size_t first = ChunkSizes(mesh.header, 0, extent.first_tet).tets;
    MeshView chunk = mesh.view();
    chunk.tets = chunk.tets.subspan(first, ChunkSizes(mesh.header, 0, extent.tet_count).tets);
    stats[i] = measure_tets(chunk);
  });
  return sum_of(stats);
}

}  // namespace tet
