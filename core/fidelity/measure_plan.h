// Fidelity of a mesh that nobody holds: its chunks are made to be measured, and dropped.
#pragma once

#include <cstdint>

#include <absl/status/statusor.h>

#include "core/base/cancel.h"
#include "core/fidelity/fidelity.h"
#include "core/plan/mesh_plan.h"
#include "core/plan/mesh_request.h"

namespace tet {

/// Memory that measuring a mesh takes, bytes: its vertices, what is known of each face, and the
/// bricks that phi's surface is looked for in.
std::uint64_t fidelity_bytes(const MeshPlan& plan, int threads) noexcept;

/// Makes all chunks of a plan, which has faces, twice: for its vertices and its faces, and then
/// for its tets. What it says is what it would say of the mesh in memory, to the last bit.
/// `request` is the plan's. Parallel; run it on a TaskPool. Errors: those of measure_fidelity.
absl::StatusOr<MeshFidelity> fidelity_of(const MeshPlan& plan,
                                         const MeshRequest& request,
                                         const Cancellation& cancellation);

/// About how long that takes where all chunks are made in `fill_seconds` on so many threads.
double fidelity_seconds(const MeshPlan& plan, double fill_seconds, int threads) noexcept;

}  // namespace tet
