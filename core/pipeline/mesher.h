// The whole mesh at once, into memory.
#pragma once

#include <functional>
#include <optional>

#include <absl/status/statusor.h>

#include "core/base/parallel.h"
#include "core/pipeline/mesh_plan.h"

namespace tet {

struct MeshResult {
  TetMesh mesh;
  QualityStats quality;
  ThinWalls thin_walls;
  std::optional<BoundaryTopology> boundary;  ///< see MeshPlan::boundary
  double plan_seconds = 0;                   ///< survey, octree and count
  double fill_seconds = 0;
};

/// Called now and then from meshing threads with a fraction in [0, 1]; must be thread-safe.
using ProgressFunction = std::function<void(double fraction)>;

/// Plans and fills a mesh on `pool`. Errors: those of plan_mesh.
absl::StatusOr<MeshResult> mesh_volume(TaskPool& pool,
                                       std::shared_ptr<const Volume> volume,
                                       const MeshRequest& request,
                                       const MeshLimits& limits,
                                       const Cancellation& cancellation,
                                       const ProgressFunction& progress);

}  // namespace tet
