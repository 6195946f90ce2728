// Solids and a request, as what a mesh of labels is made from: each level set of several, or
// each part of a scene, is a label.
#pragma once

#include <absl/status/statusor.h>

#include "core/plan/labelled/label_plan.h"
#include "core/plan/plan_job.h"

namespace tet {

/// The job's shape is several grids, or a scene; the labels are 1, 2, ... in their order, and
/// have the names of grids and nodes unless the request names them.
///
/// Errors: kInvalidArgument (a field of the request, a scene without an end or whose last node
/// blends its parts), kFailedPrecondition (nothing is inside of any of them; a grid whose
/// inside has no end).
absl::StatusOr<LabelJob> make_solid_job(const PlanJob& job);

}  // namespace tet
