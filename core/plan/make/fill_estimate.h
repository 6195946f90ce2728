// What the chunks of a counted mesh take, before they are made.
#pragma once

#include <cstdint>

#include "core/base/cancel.h"
#include "core/plan/mesh_plan.h"

namespace tet {

struct FillEstimate {
  std::uint64_t bytes = 0;  ///< of all columns together: exact
  double seconds = 0;       ///< on the threads that it was estimated on
};

/// Makes a few of the chunks, spread evenly over the mesh, and takes their time for the whole.
/// Parallel; run it on a TaskPool. Of no use once it is cancelled.
FillEstimate estimate_fill(const MeshPlan& plan, const Cancellation& cancellation);

}  // namespace tet
