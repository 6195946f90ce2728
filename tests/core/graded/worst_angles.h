// The worst dihedral angles that a graded surface's rules allow, by an adversarial search.
#pragma once

#include <string>
#include <vector>

#include "core/graded/graded_warp.h"
#include "tests/core/graded/background_places.h"

namespace tet::test {

struct WorstAngles {
  double min_deg = 180, max_deg = 0;
  std::string min_signs;  ///< of the tet, sorted
};

/// Searches the worst angles of one tet: over all signs of its nodes, all edges along which its
/// `0` nodes may have moved, and cut points and moves at the ends of their ranges and in the
/// middle; then downhill from the worst ones. Stops where an angle is below `enough_deg`.
WorstAngles worst_angles(const PlacedTet& tet, const GradedLimits& limits, double enough_deg);

}  // namespace tet::test
