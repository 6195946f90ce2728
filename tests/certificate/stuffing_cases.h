// Every tet that the stencils can emit, from the tables the mesher itself reads.
#pragma once

#include <vector>

#include "core/stuffing/warp.h"
#include "tests/certificate/problem.h"

namespace tet::certificate {

/// How columns are compared: the second only to see the proof fail.
enum class ColumnRule { kLonger, kShorter };

/// All tets inside a one-sided mesh, up to the isometries of the lattice. Named by the signs of
/// their lattice tet: `++0-`.
std::vector<Problem> one_sided_cases(const WarpLimits& limits, ColumnRule rule);

}  // namespace tet::certificate
