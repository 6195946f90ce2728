#include "core/plan/make/plan_mesh.h"

#include <utility>

#include "core/plan/brick/plan_bricks.h"
#include "core/plan/budget.h"
#include "core/plan/improved_plan.h"
#include "core/plan/joined/joined_plan.h"
#include "core/plan/leaf_budget.h"
#include "core/plan/make/fill_mesh.h"
#include "core/plan/prepared_mesh.h"
#include "core/plan/whole/whole_plan.h"

namespace tet {
namespace {

/// Improves the mesh, which is whole for as long as that takes.
absl::StatusOr<std::shared_ptr<const MeshPlan>> improve_plan(
    std::shared_ptr<const LatticePlan> plan,
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

absl::StatusOr<std::shared_ptr<const MeshPlan>> plan_mesh(const PlanJob& job,
                                                          const Cancellation& cancellation) {
  if (grids_of(job.shape) != nullptr) {
    const auto plan_one = [&](const PlanJob& one) { return plan_mesh(one, cancellation); };
    return plan_joined(job, plan_one, cancellation);
  }
  auto plan = plan_on_lattice(job, cancellation);
  if (!plan.ok() || !job.request.improve) return plan;
  return improve_plan(*std::move(plan), job, cancellation);
}

}  // namespace tet
