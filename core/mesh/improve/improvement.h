// What the improvement of a mesh did.
#pragma once

#include <cstdint>

namespace tet {

/// Angles are those of the whole mesh.
struct Improvement {
  double min_dihedral_before_deg = 180;
  double max_dihedral_before_deg = 0;
  std::uint64_t moved_vertices = 0;
  double seconds = 0;
};

}  // namespace tet
