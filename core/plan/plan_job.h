// What a plan is made from, for every kind of mesh.
#pragma once

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
};

}  // namespace tet
