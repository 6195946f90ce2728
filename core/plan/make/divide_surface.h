// The surface of a planned mesh, divided at its creases.
#pragma once

#include <memory>

#include <absl/status/statusor.h>

#include "core/base/cancel.h"
#include "core/plan/mesh_plan.h"
#include "core/plan/mesh_request.h"

namespace tet {

/// Returns a plan of the same mesh whose regions with creases are divided into patches: see
/// divide_regions. Chunks that have faces, and those whose vertices they have, are made for it
/// once more, and nothing is kept of them but places, faces and labels.
///
/// Parallel; run it on a TaskPool. Errors: kResourceExhausted (over the limits),
/// kInvalidArgument (that of divide_regions), kCancelled, kDeadlineExceeded.
absl::StatusOr<std::shared_ptr<const MeshPlan>> divide_surface(
    std::shared_ptr<const MeshPlan> plan,
    const MeshLimits& limits,
    const Cancellation& cancellation);

}  // namespace tet
