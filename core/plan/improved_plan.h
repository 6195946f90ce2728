// A mesh whose vertices were moved: a plan with all positions in memory.
#pragma once

#include <cstdint>
#include <memory>

#include "core/base/byte_buffer.h"
#include "core/plan/mesh_plan.h"
#include "core/plan/movable_plan.h"

namespace tet {

/// Chunks are those of the plan as it was at first, with other positions.
class ImprovedPlan final : public MeshPlan {
 public:
  /// `positions` has those of all vertices, as an improvement left them.
  ImprovedPlan(std::shared_ptr<const MovablePlan> unimproved,
               ByteBuffer positions,
               const Improvement& improvement,
               Statistics statistics);

  const MovablePlan& unimproved() const noexcept { return *unimproved_; }

  ChunkExtent chunk(std::uint64_t index) const noexcept override;
  QualityStats fill_chunk(std::uint64_t index,
                          MeshWorkspace& workspace,
                          ChunkColumns columns) const noexcept override;
  std::uint64_t bytes() const noexcept override;

 private:
  const std::shared_ptr<const MovablePlan> unimproved_;
  const ByteBuffer positions_;
};

}  // namespace tet
