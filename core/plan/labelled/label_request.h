// A segmentation and a request, as what a mesh of labels is made from.
#pragma once

#include <memory>

#include <absl/status/statusor.h>

#include "core/base/cancel.h"
#include "core/plan/labelled/label_plan.h"
#include "core/plan/plan_job.h"

namespace tet {

/// Errors: kInvalidArgument (a field of the request), kFailedPrecondition (nothing but
/// background).
absl::StatusOr<LabelJob> make_label_job(const PlanJob& job);

/// Plans the mesh of a job whose shape is a segmentation. Errors: those of make_label_job and
/// plan_labels.
absl::StatusOr<std::shared_ptr<const LabelPlan>> plan_label_image(
    const PlanJob& job, const Cancellation& cancellation);

}  // namespace tet
