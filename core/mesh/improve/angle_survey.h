// Tets whose angles are not good.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/dihedral.h"
#include "core/mesh/improve/improvement.h"
#include "core/mesh/improve/star.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// Angles that need no improvement, as a goal.
AngleGoal good_angles();

/// Tets with angles that are not good, ascending, and the angles of all.
struct AngleSurvey {
  AngleRange angles;
  std::vector<std::uint64_t> bad_tets;

  void add(const AngleSurvey& other) {
    angles.add(other.angles);
    bad_tets.insert(bad_tets.end(), other.bad_tets.begin(), other.bad_tets.end());
  }
};

/// What an improvement begins with: the angles before it.
Improvement improvement_from(const AngleSurvey& survey);

/// Measures all tets as they are stored. Parallel; one value for any number of threads.
AngleSurvey survey_angles(const TetMesh& mesh, const AngleGoal& goal);

}  // namespace tet
