// One lane of a batch: a tet's angles and volume in float arithmetic, without a branch, so that
// a loop over lanes becomes vector instructions.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "core/base/tet_geometry.h"

namespace tet {

using FloatVector = BasicVector<float>;

/// Cosines are sign(cos) * cos^2, and -1 at a face without area; rounding may put them above 1.
struct LaneAngles {
  std::array<float, 6> cosine;
  float six_volumes;
};

// Unlike std::min and std::max these become one instruction. The second number wins when the
// first is none.
inline float lower(float a, float b) noexcept { return a < b ? a : b; }
inline float higher(float a, float b) noexcept { return a > b ? a : b; }

/// A face's normal and what the cosines at its edges are divided by.
struct LaneFace {
  FloatVector normal;
  float per_square;  ///< 1 / |normal|^2

  explicit LaneFace(const FloatVector& n) noexcept : normal(n), per_square(1 / dot(n, n)) {}
};

inline float signed_square_of_cosine(const LaneFace& f, const LaneFace& g) noexcept {
  const float inward = -dot(f.normal, g.normal);
  return higher((inward * f.per_square) * (std::abs(inward) * g.per_square), -1);
}

/// `u`, `v` and `w` lead from a tet's first corner to the others.
[[gnu::always_inline]] inline LaneAngles measure_lane(const FloatVector& u,
                                                      const FloatVector& v,
                                                      const FloatVector& w) noexcept {
  const LaneFace a(cross(w - u, v - u)), b(cross(v, w)), c(cross(w, u)), d(cross(u, v));
  return {{signed_square_of_cosine(a, b), signed_square_of_cosine(a, c),
           signed_square_of_cosine(a, d), signed_square_of_cosine(b, c),
           signed_square_of_cosine(b, d), signed_square_of_cosine(c, d)},
          dot(u, b.normal)};
}

/// Degrees of asin(sqrt(t)) for t in [0, 1/2]: sqrt(t) times a polynomial that is off by 1.4e-4
/// degrees at most (found by Remez exchange).
inline float degrees_of_arc_sine(float t) noexcept {
  const float low = 57.2978251F + 9.47438572F * t, middle = 5.05318527F - 0.425775705F * t;
  const float square = t * t;
  return std::sqrt(t) * (low + square * (middle + square * 6.30918103F));
}

/// Whole degrees of an angle, 0 to 180; one within 2e-4 of the next is rounded up.
[[gnu::always_inline]] inline std::int32_t whole_degrees(float cosine) noexcept {
  constexpr float kRounding = 2e-4F;
  const float square = std::abs(cosine);
  // Near 45 degrees the sine of the other acute angle takes over. Both conditions say so, but
  // one of them twice would be made into a branch.
  // Beyond a half is only what a tet almost without volume made of its zeros.
  const float part = degrees_of_arc_sine(lower(lower(square, std::abs(1 - square)), 0.5F));
  const float from_right = square < 0.5F ? part : 90 - part;
  return static_cast<std::int32_t>(90 + kRounding - std::copysign(from_right, cosine));
}

}  // namespace tet
