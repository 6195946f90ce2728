#include "core/pipeline/fill_mesh.h"

#include <atomic>
#include <cstddef>
#include <utility>
#include <vector>

#include "core/base/parallel.h"
#include "core/pipeline/survey.h"

namespace tet {
namespace {

QualityStats sum_of(const std::vector<QualityStats>& chunks) {
  QualityStats sum;
  for (const QualityStats& chunk : chunks) sum.add(chunk);
  return sum;
}

}  // namespace

absl::StatusOr<FilledMesh> fill_mesh(const MeshPlan& plan,
                                     const Cancellation& cancellation,
                                     const ProgressFunction& progress,
                                     TetMesh used,
                                     FieldValues fields) {
  const std::uint64_t chunks = plan.header().chunk_count;
  MeshHeader header = plan.header();
  if (fields == FieldValues::kLater) header.fields.clear();
  TetMesh mesh(header, std::move(used));
  std::vector<QualityStats> stats(chunks);
  std::atomic<std::uint64_t> done{0};
  for_each_range(chunks, 1, [&](std::size_t begin, std::size_t end) {
    MeshWorkspace workspace;
    for (std::size_t i = begin; i < end && !cancellation.requested(); ++i) {
      stats[i] = plan.fill_chunk(i, workspace, mesh.columns_of(plan.chunk(i)));
      if (progress) progress(static_cast<double>(++done) / static_cast<double>(chunks));
    }
  });
  if (absl::Status status = check_cancelled(cancellation); !status.ok()) return status;
  return FilledMesh{std::move(mesh), sum_of(stats)};
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
