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
#include "core/plan/mesh_progress.h"
#include "core/plan/mesh_request.h"
#include "core/plan/movable_plan.h"
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
  /// Its `levels`, `origin`, `coordinates`, `indices`, `fields`, `improve` and
  /// `skip_statistics`; others are not looked at.
  MeshRequest request = {};
  MeshLimits limits = {};
  MeshProgress* progress = nullptr;  ///< may be null
};

/// What a mesh of labels was made from, and where its lattice lies.
struct LabelledSource {
  std::shared_ptr<const LabelSource> labels;
  LatticeToWorld to_world;
  std::vector<VertexField> fields = {};
};

/// Chunks are runs of bricks.
class LabelPlan final : public MovablePlan {
 public:
  LabelPlan(MeshFacts facts,
            LabelledSource source,
            CountedLabels mesh,
            std::vector<std::size_t> first_brick);

  const LatticeToWorld& to_world() const noexcept { return source_.to_world; }
  const CountedLabels& counted() const noexcept { return mesh_; }

  ChunkExtent chunk(std::uint64_t index) const noexcept override;
  QualityStats fill_chunk(std::uint64_t index,
                          MeshWorkspace& workspace,
                          ChunkColumns columns) const noexcept override;
  std::uint64_t bytes() const noexcept override;
  Improvement improve(TetMesh& mesh, const Cancellation& cancellation) const override;
  void fill_fields(const ChunkExtent& extent,
                   const ChunkColumns& columns) const noexcept override;

 private:
  ChunkExtent bricks(std::size_t begin, std::size_t end) const noexcept;

  const LabelledSource source_;
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
