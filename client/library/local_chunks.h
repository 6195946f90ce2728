// A mesh that is made in this process, chunk by chunk.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "client/library/chunk_supply.h"
#include "client/library/reused_chunk.h"
#include "core/base/cancel.h"
#include "core/base/parallel.h"
#include "core/plan/make/fill_mesh.h"
#include "core/plan/make/plan_mesh.h"
#include "core/plan/mesh_plan.h"
#include "core/plan/mesh_request.h"
#include "core/plan/mesh_workspace.h"
#include "core/plan/shape.h"

namespace tet {

/// Some of a mesh's chunks: from `first` on, up to `end` where that is given.
struct LocalRange {
  std::uint64_t first = 0;
  std::optional<std::uint64_t> end = {};
};

/// What is made, and how.
struct LocalWork {
  Shape shape;
  MeshRequest request;
  int threads = 0;                      ///< <= 0 takes every core
  ProgressFunction progress = nullptr;  ///< may be null
  LocalRange range = {};
};

/// Makes a few chunks at a time, as many as keep its threads busy, when the first of them is
/// asked for. The bytes are those of the mesh that mesh_volume makes.
class LocalChunks : public ChunkSupply {
 public:
  /// `cancellation` outlives this.
  LocalChunks(LocalWork work, const Cancellation& cancellation);

  absl::StatusOr<const MeshHeader*> header() override;
  absl::StatusOr<const ChunkView*> next() override;
  std::shared_ptr<const TetMesh> keep() const override;
  const TrailerFacts& facts() const override { return facts_; }

 private:
  /// A chunk, its memory and its thread's, which the next batch uses again.
  struct Made {
    ReusedChunk columns;
    MeshWorkspace workspace;
    QualityStats quality;
  };

  absl::Status plan();
  absl::Status make_batch();
  void make(std::uint64_t index, Made& made) const;
  absl::Status finish();

  LocalWork work_;
  const Cancellation& cancellation_;
  TaskPool pool_;
  std::shared_ptr<const MeshPlan> plan_;
  std::vector<Made> batch_;
  std::uint64_t next_ = 0, end_ = 0, batch_begin_ = 0, batch_end_ = 0;
  QualityStats quality_;
  ChunkView chunk_;
  TrailerFacts facts_;
  bool finished_ = false;
  absl::Status failure_;
};

}  // namespace tet
