// What of space a mesh of labels fills, and how it is called there.
#pragma once

#include <string_view>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "core/base/brick_box.h"
#include "core/plan/label_choice.h"
#include "core/plan/labelled/label_numbers.h"
#include "core/plan/mesh_request.h"
#include "core/plan/plan_job.h"

namespace tet {

struct LabelJob;

/// What is meshed of bricks that `what` reaches into: the request's box; without the background
/// no more of it than `what` has. Errors: kInvalidArgument (a box that holds nothing of it),
/// those of mesh_domain.
absl::StatusOr<BrickBox> label_domain(const BrickBox& reached,
                                      std::string_view what,
                                      const VoxelTransform& lattice,
                                      const MeshRequest& request);

/// Error: kInvalidArgument (a size of a label below the spacing).
absl::Status check_label_sizes(const LabelChoice& choice, double spacing);

/// Fills in what a job has of its labels and of the request.
void set_labels(const PlanJob& job, LabelNumbers numbers, LabelJob& out);

}  // namespace tet
