// A mesh whose surface is graded: made as a whole, and handed out in chunks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <absl/status/statusor.h>

#include "core/base/cancel.h"
#include "core/base/quality.h"
#include "core/graded/cut_box.h"
#include "core/mesh/boundary.h"
#include "core/mesh/lattice_to_world.h"
#include "core/mesh/tet_mesh.h"
#include "core/octree/leaf_rules.h"
#include "core/plan/mesh_request.h"
#include "core/plan/prepared_mesh.h"

namespace tet {

struct GradedMesh {
  TetMesh mesh;
  LatticeToWorld to_world;
  std::vector<std::uint8_t>
      vertex_levels;                   ///< octree level of the smallest leaves at each vertex
  std::vector<CutFaces> vertex_faces;  ///< faces of the request's box, where there is one
  std::optional<BoundaryTopology> boundary;  ///< unless the request skips statistics

  /// Chunk `index` of as many as the header says: equal parts of the vertices and of the tets.
  ChunkExtent chunk(std::uint64_t index) const noexcept;
  /// Copies it.
  void fill_chunk(std::uint64_t index, ChunkColumns columns) const noexcept;

  std::uint64_t bytes() const noexcept;
};

/// Without a tet where nothing is inside. Parallel; run it on a TaskPool.
/// Errors: kResourceExhausted (over `limits`), kCancelled, kDeadlineExceeded.
absl::StatusOr<GradedMesh> make_graded_mesh(const PreparedMesh& prepared,
                                            const MeshRequest& request,
                                            LeafRules rules,
                                            const MeshLimits& limits,
                                            const Cancellation& cancellation);

}  // namespace tet
