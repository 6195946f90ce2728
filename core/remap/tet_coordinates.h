// Where a point lies in a tet: the shares of its corners.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/tet_geometry.h"
#include "core/base/types.h"

namespace tet {

/// Six times the volume; negative where the tet is turned over.
inline double six_volumes(const std::array<WorldPoint, 4>& t) noexcept {
  return dot(cross(from_to(t[0], t[1]), from_to(t[0], t[2])), from_to(t[0], t[3]));
}

using CornerShares = std::array<double, 4>;

/// The shares that add up to one and give `p`; none is negative within the tet. All are not
/// numbers where the tet has no volume.
inline CornerShares shares_of(const std::array<WorldPoint, 4>& t,
                              const WorldPoint& p) noexcept {
  const Vector b = from_to(t[0], t[1]), c = from_to(t[0], t[2]), d = from_to(t[0], t[3]);
  const Vector at = from_to(t[0], p);
  const Vector cd = cross(c, d);
  const double all = dot(b, cd);
  const Vector ab = cross(at, b);
  const double to_b = dot(at, cd) / all, to_c = -dot(ab, d) / all, to_d = dot(ab, c) / all;
  return {1 - to_b - to_c - to_d, to_b, to_c, to_d};
}

inline double least_of(const CornerShares& shares) noexcept {
  return std::min({shares[0], shares[1], shares[2], shares[3]});
}

}  // namespace tet
