// The plan of a mesh that was made as a whole while it was planned: its surface is graded, or a
// box cuts it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <absl/status/statusor.h>

#include "core/base/cancel.h"
#include "core/graded/cut_box.h"
#include "core/octree/leaf_rules.h"
#include "core/plan/lattice_plan.h"
#include "core/plan/plan_job.h"
#include "core/plan/prepared_mesh.h"

namespace tet {

/// A mesh in memory, and what is known of its vertices.
struct WholeMesh {
  TetMesh mesh;  ///< with its faces, without fields, which are sampled chunk by chunk
  /// Octree level of the smallest leaves at each vertex.
  std::vector<std::uint8_t> vertex_levels = {};
  /// Faces of the request's box that each vertex lies in; empty where there is no box.
  std::vector<CutFaces> vertex_faces = {};

  std::uint64_t bytes() const noexcept;
};

/// Chunks are equal parts of the vertices and of the tets.
class WholePlan final : public LatticePlan {
 public:
  WholePlan(MeshFacts facts, MeshSource source, WholeMesh whole);

  ChunkExtent chunk(std::uint64_t index) const noexcept override;
  QualityStats fill_chunk(std::uint64_t index,
                          MeshWorkspace& workspace,
                          ChunkColumns columns) const noexcept override;
  std::uint64_t bytes() const noexcept override { return whole_.bytes(); }

 private:
  KnownOfVertices known_of_vertices() const noexcept override;

  const WholeMesh whole_;
};

/// Parallel; run it on a TaskPool. Errors: kFailedPrecondition (there is nothing to mesh),
/// kResourceExhausted (over the job's limits), kInvalidArgument (the request's origin),
/// kCancelled, kDeadlineExceeded.
absl::StatusOr<std::shared_ptr<const LatticePlan>> plan_whole(const PlanJob& job,
                                                              const PreparedMesh& prepared,
                                                              LeafRules rules,
                                                              const Cancellation& cancellation);

}  // namespace tet
