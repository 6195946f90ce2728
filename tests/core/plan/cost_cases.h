// Requests of every kind whose plans cost most for what they look like.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/plan/plan_job.h"
#include "core/plan/shape.h"

namespace tet::test {

/// What a client may ask for in a few hundred bytes, or with a small file.
struct CostCase {
  std::string name;
  Shape shape;
  MeshRequest request;
};

/// The plan that prices are told in: a ball's, about its voxels' own lattice.
CostCase plain_ball(double radius);

/// One of each kind. `size` is about how much there is of it: 1 takes tens of milliseconds
/// each, and the work grows with its square.
std::vector<CostCase> cost_cases(double size);

}  // namespace tet::test
