// The whole mesh at once, into memory.
#pragma once

#include <functional>
#include <optional>

#include <absl/status/statusor.h>

#include "core/base/parallel.h"
#include "core/plan/make/fill_mesh.h"
#include "core/plan/mesh_plan.h"
#include "core/plan/mesh_request.h"

namespace tet {

/// Says who takes a mesh of this header part by part, once that is known; null where it is to
/// be made as a whole. An error ends the mesh.
using ChooseTaker = std::function<absl::StatusOr<TakePart>(const MeshHeader& header)>;

/// What a whole mesh is made from.
struct MeshJob {
  Shape shape = {};
  MeshRequest request = {};
  MeshLimits limits = {};
  ProgressFunction progress = nullptr;  ///< may be null
  /// A mesh that is no longer needed: whoever makes one mesh after another in the same memory
  /// saves the first touch of its pages, up to a third of the time.
  TetMesh used = {};
  /// Where this is set and gives somebody, the result's mesh is nothing but its header. Not
  /// asked for meshes that are improved where they lie.
  ChooseTaker choose_taker = nullptr;
};

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

/// Plans and fills a mesh on `pool`, and improves it where the request asks for it. Errors:
/// those of plan_mesh.
absl::StatusOr<MeshResult> mesh_volume(TaskPool& pool,
                                       MeshJob job,
                                       const Cancellation& cancellation = {});

}  // namespace tet
