// Where a point lies in a tet: the shares of its corners.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/base/tet_geometry.h"
#include "core/base/types.h"

namespace tet {

/// Six times the volume; negative where the tet is turned over.
inline double six_volumes(const std::array<WorldPoint, 4>& t) noexcept {
  return dot(cross(from_to(t[0], t[1]), from_to(t[0], t[2])), from_to(t[0], t[3]));
}

inline double longest_edge(const std::array<WorldPoint, 4>& t) noexcept {
  double longest = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = i + 1; j < 4; ++j) {
      const Vector edge = from_to(t[i], t[j]);
      longest = std::max(longest, dot(edge, edge));
    }
  }
  return std::sqrt(longest);
}

/// Whether the volume, `six` of them together, is so little that rounding may be the most of
/// it: that rounds by about 1e-15 of the cube, and four figures are left where this says no.
/// What is computed from a flat tet's planes may be anything.
inline bool is_flat(const std::array<WorldPoint, 4>& t, double six) noexcept {
  constexpr double kFlat = 1e-12;
  const double longest = longest_edge(t);
  return !(std::abs(six) > kFlat * longest * longest * longest);
}
inline bool is_flat(const std::array<WorldPoint, 4>& t) noexcept {
  return is_flat(t, six_volumes(t));
}

using CornerShares = std::array<double, 4>;

/// The shares that add up to one and give `p`; none is negative within the tet. They may be
/// anything, and no numbers, where the tet is flat.
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
