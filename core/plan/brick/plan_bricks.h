// From a prepared mesh to the plan of its bricks: surveyed, coarsened and counted.
#pragma once

#include <memory>

#include <absl/status/statusor.h>

#include "core/base/cancel.h"
#include "core/octree/leaf_rules.h"
#include "core/plan/lattice_plan.h"
#include "core/plan/plan_job.h"
#include "core/plan/prepared_mesh.h"

namespace tet {

/// Signs, cut points and warps are surveyed, leaves chosen, and every vertex and tet given its
/// place. Parallel; run it on a TaskPool. Errors: kFailedPrecondition (there is nothing to
/// mesh), kResourceExhausted (over the job's limits), kInvalidArgument (the request's origin),
/// kCancelled, kDeadlineExceeded.
absl::StatusOr<std::shared_ptr<const LatticePlan>> plan_bricks(
    const PlanJob& job,
    const PreparedMesh& prepared,
    const LeafRules& rules,
    const Cancellation& cancellation);

}  // namespace tet
