#include "core/plan/mesher.h"

#include <chrono>
#include <utility>

#include "core/plan/brick/survey.h"

namespace tet {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

absl::StatusOr<MeshResult> make_mesh(Shape shape,
                                     const MeshRequest& request,
                                     const MeshLimits& limits,
                                     const Cancellation& cancellation,
                                     const ProgressFunction& progress,
                                     TetMesh used) {
  // The mesh is improved where it lies: a plan would make it once more. Those of several grids
  // are improved one by one, by their plan.
  const bool improve_here = request.improve && grids_of(shape) == nullptr;
  MeshRequest as_planned = request;
  if (improve_here) as_planned.improve = false;
  MeshResult result;
  Clock::time_point start = Clock::now();
  const auto plan = plan_mesh(std::move(shape), as_planned, limits, cancellation, nullptr);
  if (!plan.ok()) return plan.status();
  result.plan_seconds = seconds_since(start);

  start = Clock::now();
  const double share = improve_here ? 0.5 : 1;  // of the time, about
  const auto tell = [&](double fraction) {
    if (progress) progress(share * fraction);
  };
  absl::StatusOr<FilledMesh> filled =
      fill_mesh(**plan, cancellation, tell, std::move(used),
                improve_here ? FieldValues::kLater : FieldValues::kNow);
  if (!filled.ok()) return filled.status();
  result.mesh = std::move(filled->mesh);
  result.quality = filled->quality;
  result.thin_walls = (*plan)->thin_walls();
  result.boundary = (*plan)->boundary();
  result.fill_seconds = seconds_since(start);

  if (!improve_here) {
    result.improvement = (*plan)->improvement();
    if (result.improvement) result.improve_seconds = result.improvement->seconds;
    result.plan_seconds -= result.improve_seconds;
    return result;
  }
  start = Clock::now();
  result.improvement = (*plan)->improve(result.mesh, cancellation);
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  if (!request.skip_statistics) result.quality = measure_chunks(**plan, result.mesh);
  (*plan)->add_fields(result.mesh);
  result.improve_seconds = seconds_since(start);
  if (progress) progress(1);
  return result;
}

}  // namespace

absl::StatusOr<MeshResult> mesh_volume(TaskPool& pool,
                                       Shape shape,
                                       const MeshRequest& request,
                                       const MeshLimits& limits,
                                       const Cancellation& cancellation,
                                       const ProgressFunction& progress,
                                       TetMesh used) {
  absl::StatusOr<MeshResult> result = absl::UnknownError("not started");
  pool.run([&] {
    result =
        make_mesh(std::move(shape), request, limits, cancellation, progress, std::move(used));
  });
  return result;
}

}  // namespace tet
