// Geometry that differs by a turn, a reflection or a numbering only is proven once.
#pragma once

#include <vector>

#include "tests/certificate/problem.h"

namespace tet::certificate {

/// One of all problems that are alike up to an isometry of the lattice and the order in which
/// corners, tets and parameters are listed.
std::vector<Problem> without_copies(const std::vector<Problem>& problems);

}  // namespace tet::certificate
