// Everything that a mesh with a graded surface promises, checked on one random input after
// another.
#pragma once

#include <cstdint>
#include <string>

#include "core/base/parallel.h"
#include "tests/support/mesh_promises.h"

namespace tet::test {

/// A random field, or a random scene (the family "scene"), with a random sizing that grades its
/// surface; one in three is cut by a random box, and every other one of these has finest leaves
/// at its surface.
struct GradedCase {
  std::string family;
  std::uint32_t seed = 1;
  int edge = 64;  ///< of a field, voxels; of a scene, finest spacings across
};

/// What `graded_trial` has to be told to try a case again.
std::string arguments_of(const GradedCase& graded_case);

/// Meshes it, and checks that
///
/// - the mesh conforms, and its tets are positive;
/// - dihedral angles are within kLeastGradedAngleDeg and kGreatestGradedAngleDeg, or
///   kLeastCutAngleDeg and kGreatestCutAngleDeg, and those that are reported are those it has,
///   as is the volume;
/// - the vertices of the boundary lie where phi is zero, of scenes and smooth fields, and no
///   vertex lies outside, but for those in the faces of a box;
/// - what is said to lie in a face of the box does, and nothing lies beyond;
/// - the boundary's topology is what was reported;
/// - other numbers of threads and another chunk size make the same bytes, of every fourth seed.
///
/// Every eighth seed asks for improved angles. An input of which nothing can be meshed passes.
Outcome check_graded_promises(const GradedCase& graded_case, TaskPool& pool);

}  // namespace tet::test
