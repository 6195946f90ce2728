// Every tet of the graded interior, from the code that writes them.
#pragma once

#include <vector>

#include "tests/certificate/problem.h"

namespace tet::certificate {

/// The background tets around leaves of the finest size, up to the isometries of the lattice.
/// Around larger leaves they are the same, only larger.
std::vector<Problem> background_cases();

}  // namespace tet::certificate
