#include "core/plan/fill_mesh.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/parallel.h"
#include "core/base/scratch_pool.h"
#include "core/plan/brick/fill_brick.h"
#include "core/plan/brick/survey.h"

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
  std::uint64_t chunk;
  std::optional<BrickRange> bricks;
};

std::vector<PartOfChunk> parts_of(const MeshPlan& plan, const MeshHeader& header) {
  const bool bricks_alone = plan.has_bricks() && !plan.improvement() && header.fields.empty();
  std::vector<PartOfChunk> parts;
  for (std::uint64_t chunk = 0; chunk < plan.header().chunk_count; ++chunk) {
    if (!bricks_alone) {
      parts.push_back({chunk, std::nullopt});
      continue;
    }
    const auto [begin, end] = plan.bricks_of_chunk(chunk);
    for (std::size_t brick = begin; brick < end; brick += kBricksPerRun) {
      parts.push_back({chunk, BrickRange{brick, std::min(end, brick + kBricksPerRun)}});
    }
  }
  return parts;
}

QualityStats fill_part(const MeshPlan& plan,
                       const PartOfChunk& part,
                       MeshWorkspace& workspace,
                       TetMesh& mesh) {
  if (!part.bricks) {
    return plan.fill_chunk(part.chunk, workspace, mesh.columns_of(plan.chunk(part.chunk)));
  }
  return plan.fill_bricks(*part.bricks, workspace, mesh.columns_of(plan.bricks(*part.bricks)));
}

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
  const std::vector<PartOfChunk> parts = parts_of(plan, header);
  std::vector<QualityStats> stats(parts.size());
  ScratchPool<MeshWorkspace> workspaces;
  std::atomic<std::uint64_t> done{0};
  for_each_range(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
    ScratchPool<MeshWorkspace>::Turn workspace(workspaces);
    for (std::size_t i = begin; i < end && !cancellation.requested(); ++i) {
      stats[i] = fill_part(plan, parts[i], *workspace, mesh);
      if (progress) progress(static_cast<double>(++done) / static_cast<double>(parts.size()));
    }
  });
  if (absl::Status status = check_cancelled(cancellation); !status.ok()) return status;
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
