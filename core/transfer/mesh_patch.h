// What is new in a mesh that keeps parts of an earlier one, as chunks of its own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/cancel.h"
#include "core/mesh/stable/splice.h"
#include "core/plan/brick/brick_plan.h"
#include "core/plan/brick/mesh_difference.h"
#include "core/plan/brick/new_parts.h"

namespace tet {

/// Kept parts and patches: contiguous runs of the mesh's vertices and tets, or of those that
/// are not kept, which together with the kept parts are the whole mesh, byte for byte.
/// Immutable: any thread may call any member.
class MeshPatch {
 public:
  /// `mesh` as it differs from `earlier`, on its own TaskPool's threads. Null where the whole
  /// mesh is to be sent: one of them is null (see as_bricks), they have other rules, types,
  /// spacings or origins, or the limits say so (see compare_meshes). Null, too, once
  /// `cancellation` is requested: whoever got nothing looks whether it is.
  static std::shared_ptr<const MeshPatch> between(
      const std::shared_ptr<const BrickPlan>& earlier,
      std::shared_ptr<const BrickPlan> mesh,
      const Cancellation& cancellation,
      PatchDetail detail = PatchDetail::kBricks,
      PatchLimits limits = {});

  const KeptParts& kept() const noexcept { return difference_.kept; }

  std::uint64_t patch_count() const noexcept { return difference_.changed.size(); }
  /// A run of the mesh; where kept().loose, of what is not kept.
  ChunkExtent extent(std::uint64_t patch) const noexcept;
  /// Makes one patch; its bytes depend on both volumes, the request and `patch` alone. See
  /// MeshPlan::fill_chunk.
  QualityStats fill(std::uint64_t patch,
                    MeshWorkspace& workspace,
                    ChunkColumns columns) const noexcept;

  MeshPatch(const MeshPatch&) = delete;  // its own members look at others of them
  MeshPatch& operator=(const MeshPatch&) = delete;

 private:
  MeshPatch(std::shared_ptr<const BrickPlan> mesh, MeshDifference difference);

  ChunkExtent extent_of(const BrickRange& bricks) const noexcept;
  std::vector<BrickRange> within_chunk_size() const;

  std::shared_ptr<const BrickPlan> mesh_;
  MeshDifference difference_;
  NewParts new_;  ///< of the difference
};

}  // namespace tet
