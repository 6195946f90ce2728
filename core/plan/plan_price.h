// What planning a mesh looks to take, before any of it is done.
#pragma once

#include <chrono>

#include "core/plan/mesh_request.h"
#include "core/plan/shape.h"

namespace tet {

/// About how many bricks planning looks at, to tell long work from short. Whatever else takes
/// long counts as the bricks of a plain surface that take as long: solids of a scene, surfaces
/// that fill their bricks, the inside, what a request asks for besides. Looks at a few bricks
/// of the shape: what it takes is bounded by what a few bricks take, whatever the shape. A test
/// compares it with what plans take (tests/core/plan/cost_test.cpp).
double estimate_bricks_to_plan(const Shape& shape, const MeshRequest& request);

/// What a brick takes of a core: of Debian 12 on an AMD EPYC at 2.6 GHz.
inline constexpr std::chrono::nanoseconds kBrickTime{25'000};

}  // namespace tet
