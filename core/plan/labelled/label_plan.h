// The plan of a segmentation's mesh: every label a part of it, interfaces shared.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "core/base/cancel.h"
#include "core/labels/label_samples.h"
#include "core/mesh/lattice_to_world.h"
#include "core/plan/labelled/counted_labels.h"
#include "core/plan/mesh_plan.h"
#include "core/plan/mesh_progress.h"
#include "core/plan/mesh_request.h"
#include "core/volume/volume.h"

namespace tet {

/// What a mesh of labels is made from.
struct LabelJob {
  Shape shape = {};  ///< what the source is of, which the plan keeps; may be null
  std::shared_ptr<const LabelSource> source;
  VoxelTransform lattice;         ///< world = linear * lattice + translation, in spacings
  BrickBox domain;                ///< finest bricks
  std::vector<MeshLabel> labels;  ///< by number: those that the source has
  std::vector<double> largest_leaf = {};  ///< of each, world units; none: any
  KeptLabels kept = {};
  std::string inside_guess = {};  ///< MeshHeader::inside_guess
  /// Its `levels`, `origin`, `coordinates`, `indices`, `fields` and `skip_statistics`; others
  /// are not looked at.
  MeshRequest request = {};
  MeshLimits limits = {};
  MeshProgress* progress = nullptr;  ///< may be null
};

/// Chunks are runs of bricks.
class LabelPlan final : public MeshPlan {
 public:
  LabelPlan(MeshFacts facts,
            const LatticeToWorld& to_world,
            std::vector<VertexField> fields,
            CountedLabels mesh,
            std::vector<std::size_t> first_brick);

  const LatticeToWorld& to_world() const noexcept { return to_world_; }
  const CountedLabels& counted() const noexcept { return mesh_; }

  ChunkExtent chunk(std::uint64_t index) const noexcept override;
  QualityStats fill_chunk(std::uint64_t index,
                          MeshWorkspace& workspace,
                          ChunkColumns columns) const noexcept override;
  std::uint64_t bytes() const noexcept override;

 private:
  ChunkExtent bricks(std::size_t begin, std::size_t end) const noexcept;

  const LatticeToWorld to_world_;
  const std::vector<VertexField> fields_;
  const CountedLabels mesh_;
  const std::vector<std::size_t> first_brick_;  // of each chunk, and the number of bricks
};

/// Counts the mesh. Parallel; run it on a TaskPool.
///
/// Errors: kInvalidArgument (the request's origin), kFailedPrecondition (no label that is
/// meshed fills anything), kResourceExhausted (over the limits), kCancelled, kDeadlineExceeded.
absl::StatusOr<std::shared_ptr<const LabelPlan>> plan_labels(
    const LabelJob& job, const Cancellation& cancellation = {});

}  // namespace tet
