// Where a plan is made, whatever kind of mesh is asked for.
#pragma once

#include <memory>

#include <absl/status/statusor.h>

#include "core/base/cancel.h"
#include "core/plan/lattice_plan.h"
#include "core/plan/mesh_plan.h"
#include "core/plan/plan_job.h"

namespace tet {

/// Counts the mesh. A request to improve it makes the whole of it here once, and keeps the
/// improved positions. Parallel; run it on a TaskPool.
///
/// Errors: kInvalidArgument (a field of the request), kFailedPrecondition (the shape has no
/// surface at this iso value, or its inside has no end), kResourceExhausted (over the limits),
/// kCancelled, kDeadlineExceeded.
absl::StatusOr<std::shared_ptr<const MeshPlan>> plan_mesh(
    const PlanJob& job, const Cancellation& cancellation = {});

/// Plans the mesh of one grid or scene before the improvement that the request may ask for.
absl::StatusOr<std::shared_ptr<const LatticePlan>> plan_on_lattice(
    const PlanJob& job, const Cancellation& cancellation = {});

}  // namespace tet
