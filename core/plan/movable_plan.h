// A plan whose mesh can be improved: its vertices may move once they are made.
#pragma once

#include "core/base/cancel.h"
#include "core/mesh/improve/improvement.h"
#include "core/plan/mesh_plan.h"
#include "core/plan/mesh_request.h"

namespace tet {

/// Whether chunks are measured as they come at first: a mesh that is to be improved is measured
/// afterwards.
Statistics statistics_before_moves(const MeshRequest& request);

class MovablePlan : public MeshPlan {
 public:
  /// Improves the whole mesh as this plan's chunks make it.
  virtual Improvement improve(TetMesh& mesh, const Cancellation& cancellation) const = 0;

  /// Gives the values of the request's fields to the vertices of `extent`, wherever they lie by
  /// now: `columns` has their positions.
  virtual void fill_fields(const ChunkExtent& extent,
                           const ChunkColumns& columns) const noexcept = 0;

  /// Gives them to a whole mesh of this plan. Parallel; run it on a TaskPool.
  void add_fields(TetMesh& mesh) const;

 protected:
  using MeshPlan::MeshPlan;
};

}  // namespace tet
