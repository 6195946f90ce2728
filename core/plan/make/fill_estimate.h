// What the chunks of a counted mesh take, before they are made.
#pragma once

#include <chrono>
#include <cstdint>

#include "core/base/cancel.h"
#include "core/plan/mesh_plan.h"

namespace tet {

struct FillEstimate {
  std::uint64_t bytes = 0;  ///< of all columns together: exact
  double seconds = 0;       ///< on the threads that it was estimated on
};

/// Makes a few of the chunks, spread evenly over the mesh, and takes their time for the whole:
/// fewer of them once `most` has passed. Parallel; run it on a TaskPool. If it is cancelled,
/// discard the result.
FillEstimate estimate_fill(const MeshPlan& plan,
                           const Cancellation& cancellation,
                           std::chrono::nanoseconds most = std::chrono::nanoseconds::max());

}  // namespace tet
