#include "core/pipeline/mesher.h"

#include <atomic>
#include <chrono>
#include <utility>
#include <vector>

#include "core/pipeline/survey.h"

namespace tet {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Makes every chunk where it belongs in the mesh; chunks may come in any order.
absl::StatusOr<MeshResult> fill_mesh(const MeshPlan& plan,
                                     const Cancellation& cancellation,
                                     const ProgressFunction& progress) {
  const std::uint64_t chunks = plan.header().chunk_count;
  MeshResult result;
  result.mesh = TetMesh(plan.header());
  result.thin_walls = plan.thin_walls();
  std::vector<QualityStats> stats(chunks);
  std::atomic<std::uint64_t> done{0};
  for_each_range(chunks, 1, [&](std::size_t begin, std::size_t end) {
    MeshWorkspace workspace;
    for (std::size_t i = begin; i < end && !cancellation.requested(); ++i) {
      stats[i] = plan.fill_chunk(i, workspace, result.mesh.columns_of(plan.chunk(i)));
      if (progress) progress(static_cast<double>(++done) / static_cast<double>(chunks));
    }
  });
  if (absl::Status status = check_cancelled(cancellation); !status.ok()) return status;
  for (const QualityStats& chunk : stats) result.quality.add(chunk);
  result.boundary = plan.boundary();
  return result;
}

}  // namespace

absl::StatusOr<MeshResult> mesh_volume(TaskPool& pool,
                                       std::shared_ptr<const Volume> volume,
                                       const MeshRequest& request,
                                       const MeshLimits& limits,
                                       const Cancellation& cancellation,
                                       const ProgressFunction& progress) {
  absl::StatusOr<MeshResult> result = absl::UnknownError("not started");
  pool.run([&] {
    const Clock::time_point start = Clock::now();
    const auto plan = plan_mesh(std::move(volume), request, limits, cancellation, nullptr);
    const double plan_seconds = seconds_since(start);
    if (!plan.ok()) {
      result = plan.status();
      return;
    }
    result = fill_mesh(**plan, cancellation, progress);
    if (!result.ok()) return;
    result->plan_seconds = plan_seconds;
    result->fill_seconds = seconds_since(start) - plan_seconds;
  });
  return result;
}

}  // namespace tet
