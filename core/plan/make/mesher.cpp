#include "core/plan/make/mesher.h"

#include <chrono>
#include <memory>
#include <utility>

#include "core/plan/make/plan_mesh.h"

namespace tet {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Fills the mesh of a plan. `share` of the whole work is done then.
absl::Status fill_result(const MeshPlan& plan,
                         MeshJob& job,
                         double share,
                         const Cancellation& cancellation,
                         MeshResult& result) {
  const Clock::time_point start = Clock::now();
  const auto tell = [&](double fraction) {
    if (job.progress) job.progress(share * fraction);
  };
  absl::StatusOr<FilledMesh> filled =
      fill_mesh(plan, cancellation, tell, std::move(job.used),
                share < 1 ? FieldValues::kLater : FieldValues::kNow);
  if (!filled.ok()) return filled.status();
  result.mesh = std::move(filled->mesh);
  result.quality = filled->quality;
  result.fill_seconds = seconds_since(start);
  return absl::OkStatus();
}

/// Gives the mesh of a plan away part by part.
absl::Status give_away(const MeshPlan& plan,
                       const MeshJob& job,
                       const TakePart& take,
                       const Cancellation& cancellation,
                       MeshResult& result) {
  const Clock::time_point start = Clock::now();
  const auto quality = fill_parts(plan, cancellation, job.progress, take);
  if (!quality.ok()) return quality.status();
  result.mesh.header = plan.header();
  result.quality = *quality;
  result.fill_seconds = seconds_since(start);
  return absl::OkStatus();
}

void add_facts(const MeshPlan& plan, MeshResult& result) {
  result.thin_walls = plan.thin_walls();
  result.boundary = plan.boundary();
}

/// Makes the mesh as the plan has it, improved or not.
absl::StatusOr<MeshResult> make_planned(MeshJob job, const Cancellation& cancellation) {
  MeshResult result;
  const Clock::time_point start = Clock::now();
  const auto plan = plan_mesh(
      {.shape = job.shape, .request = job.request, .limits = job.limits}, cancellation);
  if (!plan.ok()) return plan.status();
  result.plan_seconds = seconds_since(start);
  result.improvement = (*plan)->improvement();
  if (result.improvement) result.improve_seconds = result.improvement->seconds;
  result.plan_seconds -= result.improve_seconds;
  add_facts(**plan, result);
  absl::StatusOr<TakePart> take = TakePart();
  if (job.choose_taker) take = job.choose_taker((*plan)->header());
  if (!take.ok()) return take.status();
  const absl::Status status = *take ? give_away(**plan, job, *take, cancellation, result)
                                    : fill_result(**plan, job, 1, cancellation, result);
  if (!status.ok()) return status;
  return result;
}

/// Improves the mesh where it lies: an improved plan would make it once more.
absl::StatusOr<MeshResult> make_and_improve(MeshJob job, const Cancellation& cancellation) {
  MeshResult result;
  Clock::time_point start = Clock::now();
  const auto plan = plan_on_lattice(
      {.shape = job.shape, .request = job.request, .limits = job.limits}, cancellation);
  if (!plan.ok()) return plan.status();
  result.plan_seconds = seconds_since(start);
  add_facts(**plan, result);
  constexpr double kShareOfFilling = 0.5;  // of the time, about
  if (auto status = fill_result(**plan, job, kShareOfFilling, cancellation, result);
      !status.ok()) {
    return status;
  }
  start = Clock::now();
  result.improvement = (*plan)->improve(result.mesh, cancellation);
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  if (!job.request.skip_statistics) result.quality = measure_chunks(**plan, result.mesh);
  (*plan)->add_fields(result.mesh);
  result.improve_seconds = seconds_since(start);
  if (job.progress) job.progress(1);
  return result;
}

}  // namespace

absl::StatusOr<MeshResult> mesh_volume(TaskPool& pool,
                                       MeshJob job,
                                       const Cancellation& cancellation) {
  // The meshes of several grids are improved one by one, by their plan; so are those of labels,
  // whose faces are found afterwards, and a surface is divided when it is improved.
  const bool improve_here = job.request.improve && !job.request.labels &&
                            grids_of(job.shape) == nullptr &&
                            !have_creases(job.request.face_regions);
  absl::StatusOr<MeshResult> result = absl::UnknownError("not started");
  pool.run([&] {
    result = improve_here ? make_and_improve(std::move(job), cancellation)
                          : make_planned(std::move(job), cancellation);
  });
  return result;
}

}  // namespace tet
