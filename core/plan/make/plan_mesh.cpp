#include "core/plan/make/plan_mesh.h"

#include <utility>

#include <absl/status/status.h>
#include <absl/strings/str_format.h>

#include "core/mesh/find_faces.h"
#include "core/mesh/label_faces.h"
#include "core/plan/brick/plan_bricks.h"
#include "core/plan/budget.h"
#include "core/plan/faced_plan.h"
#include "core/plan/improved_plan.h"
#include "core/plan/joined/joined_plan.h"
#include "core/plan/labelled/label_request.h"
#include "core/plan/leaf_budget.h"
#include "core/plan/make/divide_surface.h"
#include "core/plan/make/fill_mesh.h"
#include "core/plan/prepared_mesh.h"
#include "core/plan/whole/whole_plan.h"

namespace tet {
namespace {

/// Improves the mesh, which is whole for as long as that takes.
absl::StatusOr<std::shared_ptr<const MeshPlan>> improve_plan(
    std::shared_ptr<const MovablePlan> plan,
    const PlanJob& job,
    const Cancellation& cancellation) {
  if (auto status = check_improvement_budget(plan->header(), job.limits); !status.ok()) {
    return status;
  }
  absl::StatusOr<FilledMesh> filled =
      fill_mesh(*plan, cancellation, nullptr, {}, FieldValues::kLater);
  if (!filled.ok()) return filled.status();
  const Improvement improvement = plan->improve(filled->mesh, cancellation);
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  return std::make_shared<const ImprovedPlan>(std::move(plan),
                                              std::move(filled->mesh.positions), improvement,
                                              statistics_of(job.request));
}

/// The mesh is whole while its faces are searched for, which takes memory of its own: all of it
/// is known once those that may be faces are counted.
absl::Status check_faces_budget(const MeshHeader& header,
                                std::uint64_t search_bytes,
                                const MeshLimits& limits) {
  const std::uint64_t bytes = ChunkSizes(header, whole_of(header)).total() + search_bytes;
  if (bytes <= limits.max_plan_bytes) return absl::OkStatus();
  return absl::ResourceExhaustedError(absl::StrFormat(
      "finding the faces between labels of %d vertices and %d tets would take %d bytes; the "
      "limit is %d. Use a larger spacing, or mesh without faces",
      header.vertex_count, header.tet_count, bytes, limits.max_plan_bytes));
}

absl::StatusOr<std::shared_ptr<const MeshPlan>> plan_improved_labels(
    const PlanJob& job, const Cancellation& cancellation) {
  auto plan = plan_label_image(job, cancellation);
  if (!plan.ok() || !job.request.improve) return plan;
  return improve_plan(*std::move(plan), job, cancellation);
}

/// Plans a mesh of labels. Which labels meet is known once all of it is made, so with
/// faces it is whole for as long as that takes.
absl::StatusOr<std::shared_ptr<const MeshPlan>> plan_with_labels(
    PlanJob job, const Cancellation& cancellation) {
  // A tet has four faces at most, and chunks without them leave room for as many as there are.
  if (job.request.faces) job.limits.chunk_bytes /= 3;
  auto plan = plan_improved_labels(job, cancellation);
  if (!plan.ok() || !job.request.faces) return plan;
  const MeshHeader& header = (*plan)->header();
  const std::uint64_t least = FaceSearch::bytes_of(header.vertex_count, 0);
  if (auto status = check_faces_budget(header, least, job.limits); !status.ok()) return status;
  absl::StatusOr<FilledMesh> filled = fill_mesh(**plan, cancellation, nullptr);
  if (!filled.ok()) return filled.status();
  TetMesh& mesh = filled->mesh;
  FaceSearch search(mesh, cancellation);
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  if (auto status = check_faces_budget(header, search.bytes(), job.limits); !status.ok()) {
    return status;
  }
  set_faces(faces_between_labels(mesh, search.find(), cancellation), mesh, mesh);
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  return std::make_shared<const FacedPlan>(*std::move(plan), std::move(filled->mesh));
}

}  // namespace

absl::StatusOr<std::shared_ptr<const LatticePlan>> plan_on_lattice(
    const PlanJob& job, const Cancellation& cancellation) {
  const auto prepared = prepare_mesh(job.shape, job.request, job.limits, cancellation);
  if (!prepared.ok()) return prepared.status();
  const auto rules = leaf_rules_within(job.limits, job.request.sizing, *prepared, cancellation);
  if (!rules.ok()) return rules.status();
  return is_made_whole(job.request) ? plan_whole(job, *prepared, *rules, cancellation)
                                    : plan_bricks(job, *prepared, *rules, cancellation);
}

namespace {

/// Plans a mesh whose regions are not divided at creases.
absl::StatusOr<std::shared_ptr<const MeshPlan>> plan_undivided(
    const PlanJob& job, const Cancellation& cancellation) {
  if (job.request.labels || labels_of(job.shape) != nullptr) {
    return plan_with_labels(job, cancellation);
  }
  if (grids_of(job.shape) != nullptr) {
    const auto plan_one = [&](const PlanJob& one) { return plan_undivided(one, cancellation); };
    return plan_joined(job, plan_one, cancellation);
  }
  auto plan = plan_on_lattice(job, cancellation);
  if (!plan.ok() || !job.request.improve) return plan;
  return improve_plan(*std::move(plan), job, cancellation);
}

}  // namespace

absl::StatusOr<std::shared_ptr<const MeshPlan>> plan_mesh(const PlanJob& job,
                                                          const Cancellation& cancellation) {
  auto plan = plan_undivided(job, cancellation);
  if (!plan.ok() || !have_creases(job.request.face_regions)) return plan;
  return divide_surface(*std::move(plan), job.limits, cancellation);
}

}  // namespace tet
