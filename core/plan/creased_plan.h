// A mesh whose faces got other labels once all of them were known: a plan with the labels in
// memory.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/byte_buffer.h"
#include "core/mesh/tet_mesh.h"
#include "core/plan/mesh_plan.h"

namespace tet {

/// Chunks are those of another plan, but for the labels of faces.
class CreasedPlan final : public MeshPlan {
 public:
  /// `face_labels` are places in `labels`, of all faces of the mesh.
  CreasedPlan(std::shared_ptr<const MeshPlan> undivided,
              std::vector<FaceLabel> labels,
              ByteBuffer face_labels);

  const MeshPlan& undivided() const noexcept { return *undivided_; }

  ChunkExtent chunk(std::uint64_t index) const noexcept override;
  QualityStats fill_chunk(std::uint64_t index,
                          MeshWorkspace& workspace,
                          ChunkColumns columns) const noexcept override;
  std::uint64_t bytes() const noexcept override;

 private:
  const std::shared_ptr<const MeshPlan> undivided_;
  const ByteBuffer face_labels_;
};

}  // namespace tet
