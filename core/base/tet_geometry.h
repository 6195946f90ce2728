// The few vector operations that a tet's angles and volume need.
#pragma once

#include <array>

#include "core/base/types.h"
#include "core/base/vec3.h"

namespace tet {

inline Vector from_to(const WorldPoint& a, const WorldPoint& b) noexcept {
  return {b.x - a.x, b.y - a.y, b.z - a.z};
}

/// Normals of the faces opposite a, b, c and d: all inwards when the tet is positive, and twice
/// their face's area long. The dihedral angle between faces i and j has cosine
/// -dot(n_i, n_j) / (|n_i| |n_j|).
inline std::array<Vector, 4> face_normals(const WorldPoint& a,
                                          const WorldPoint& b,
                                          const WorldPoint& c,
                                          const WorldPoint& d) noexcept {
  const Vector ab = from_to(a, b), ac = from_to(a, c), ad = from_to(a, d);
  return {cross(from_to(b, d), from_to(b, c)), cross(ac, ad), cross(ad, ab), cross(ab, ac)};
}

}  // namespace tet
