// The whole mesh at once, into memory.
#pragma once

#include <optional>

#include <absl/status/statusor.h>

#include "core/base/parallel.h"
#include "core/plan/fill_mesh.h"
#include "core/plan/mesh_plan.h"

namespace tet {

struct MeshResult {
  TetMesh mesh;
  QualityStats quality;                    ///< empty where the request skips statistics
  std::optional<Improvement> improvement;  ///< where the request asks for it
  ThinWalls thin_walls;
  std::optional<BoundaryTopology> boundary;  ///< see MeshPlan::boundary
  double plan_seconds = 0;                   ///< survey, octree and count
  double fill_seconds = 0;
  double improve_seconds = 0;  ///< and to measure what it improved
};

/// Plans and fills a mesh on `pool`, and improves it where the request asks for it. `used` is a
/// mesh that is no longer needed: whoever makes one mesh after another in the same memory saves
/// the first touch of its pages, up to a third of the time. Errors: those of plan_mesh.
absl::StatusOr<MeshResult> mesh_volume(TaskPool& pool,
                                       Shape shape,
                                       const MeshRequest& request,
                                       const MeshLimits& limits,
                                       const Cancellation& cancellation,
                                       const ProgressFunction& progress,
                                       TetMesh used = {});

}  // namespace tet
