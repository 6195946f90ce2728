// The topology of the boundary, put together from what the survey found in each brick.
#pragma once

#include <optional>

#include "core/mesh/boundary.h"
#include "core/plan/brick/survey.h"

namespace tet {

/// Returns nothing where a box cuts the surface: it has a boundary of its own then.
std::optional<BoundaryTopology> count_boundary(const Survey& survey,
                                               const Cancellation& cancellation);

}  // namespace tet
