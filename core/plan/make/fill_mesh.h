// Makes all chunks of a plan, each where it belongs in the mesh.
#pragma once

#include <functional>

#include <absl/status/statusor.h>

#include "core/base/cancel.h"
#include "core/mesh/quality.h"
#include "core/mesh/tet_mesh.h"
#include "core/plan/mesh_plan.h"

namespace tet {

/// Called now and then from meshing threads with a fraction in [0, 1]; must be thread-safe.
using ProgressFunction = std::function<void(double fraction)>;

struct FilledMesh {
  TetMesh mesh;
  QualityStats quality;  ///< empty where statistics are skipped
};

/// Whether a mesh gets the values of its fields as it is filled, or when its vertices have been
/// moved: see MovablePlan::add_fields.
enum class FieldValues : std::uint8_t { kNow, kLater };

/// Parallel; run it on a TaskPool. `progress` may be null. `used` is a mesh that is no longer
/// needed: its memory becomes the new one's. Errors: kCancelled, kDeadlineExceeded.
absl::StatusOr<FilledMesh> fill_mesh(const MeshPlan& plan,
                                     const Cancellation& cancellation,
                                     const ProgressFunction& progress,
                                     TetMesh used = {},
                                     FieldValues fields = FieldValues::kNow);

/// Takes a part of a mesh that has just been made, with the ids of the whole mesh; the part is
/// gone afterwards. Called from any of the pool's threads, in any order. An error ends the
/// mesh.
using TakePart = std::function<absl::Status(const TetMesh& part, const ChunkExtent& place)>;

/// Makes the mesh that fill_mesh makes, and keeps none of it: each part is made in memory that
/// the one before had. Returns its quality. Errors: those of fill_mesh, and of `take`.
absl::StatusOr<QualityStats> fill_parts(const MeshPlan& plan,
                                        const Cancellation& cancellation,
                                        const ProgressFunction& progress,
                                        const TakePart& take);

/// Measures a mesh whose positions moved since as its chunks would have been: the statistics
/// are the same to the last bit.
QualityStats measure_chunks(const MeshPlan& plan, const TetMesh& mesh);

}  // namespace tet
