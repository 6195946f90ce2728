// Sizes of labels become rules for an octree's leaves.
#pragma once

#include <span>
#include <vector>

#include <absl/status/statusor.h>

#include "core/base/cancel.h"
#include "core/octree/cell_set.h"
#include "core/plan/labelled/survey_labels.h"
#include "core/plan/mesh_request.h"

namespace tet {

/// Cells of each level, from 1 on, that are no leaves, as those would be larger than a label in
/// them allows: `largest_leaf` by number, world units. Parallel. If cancelled, discard it.
/// Errors: kResourceExhausted (as many leaves as a mesh within the limits has not).
absl::StatusOr<std::vector<CellSet>> cells_above_sizes(const LabelSurvey& survey,
                                                       std::span<const double> largest_leaf,
                                                       double spacing,
                                                       const MeshRequest& request,
                                                       const MeshLimits& limits,
                                                       const Cancellation& cancellation);

}  // namespace tet
