// What a plan is made from, for every kind of mesh.
#pragma once

#include <vector>

#include "core/base/types.h"
#include "core/plan/mesh_request.h"
#include "core/plan/shape.h"
#include "core/plan/surveyed_blocks.h"

namespace tet {

class MeshPlan;
struct MeshProgress;

/// Only the shape has no default that makes sense.
struct PlanJob {
  Shape shape = {};
  MeshRequest request = {};
  MeshLimits limits = {};
  MeshProgress* progress = nullptr;  ///< may be null
  /// What other hosts surveyed is not surveyed again: see divided_survey.h.
  SurveyedBlocks surveyed = {};
  /// An earlier plan, or null: what it surveyed of a shape that was the same there is not
  /// surveyed again. The new plan's chunks are the same with it and without.
  const MeshPlan* earlier = nullptr;
  /// Bricks of voxels, in any order, beyond which a grid has the values of the one that
  /// `earlier` was made from, bit by bit; they may have others too, that are as they were. The
  /// two are not compared then. Null: not known.
  const std::vector<BrickCoord>* replaced = nullptr;
};

}  // namespace tet
