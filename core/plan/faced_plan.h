// A mesh whose boundary faces were found from its tets: a plan with all faces in memory.
#pragma once

#include <cstdint>
#include <memory>

#include "core/base/byte_buffer.h"
#include "core/mesh/tet_mesh.h"
#include "core/plan/mesh_plan.h"

namespace tet {

/// Chunks are those of a plan without faces, and the faces of their tets.
class FacedPlan final : public MeshPlan {
 public:
  /// `mesh` has the faces of the plan's mesh; its other columns are let go of.
  FacedPlan(std::shared_ptr<const MeshPlan> faceless, TetMesh mesh);

  ChunkExtent chunk(std::uint64_t index) const noexcept override;
  QualityStats fill_chunk(std::uint64_t index,
                          MeshWorkspace& workspace,
                          ChunkColumns columns) const noexcept override;
  std::uint64_t bytes() const noexcept override;

 private:
  /// The first face of a tet from `tet` on.
  std::uint64_t first_face_from(std::uint64_t tet) const noexcept;

  const std::shared_ptr<const MeshPlan> faceless_;
  TetMesh faces_;  // with these columns alone
};

}  // namespace tet
