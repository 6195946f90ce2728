// Sines and cosines that have the same bits on every processor; the C library's have not.
#pragma once

#include <cmath>

namespace tet::scene {

/// sin(2 pi `turns`), to within 1e-15 for up to a million turns. Quarter turns are exact to the
/// last bit or two; whole and half ones are exactly zero.
inline double sin_of_turns(double turns) noexcept {
  const double part = turns - std::floor(turns + 0.5);  // [-0.5, 0.5], exact
  // Folded to a quarter: sin(pi - a) = sin(a).
  const double folded = std::copysign(0.5, part) - part;
  const double quarter = std::abs(part) > 0.25 ? folded : part;
  constexpr double kTwoPi = 6.283185307179586476925286766559;
  const double a = kTwoPi * quarter, s = a * a;
  // Taylor's series; the next term is below 4e-18 of a quarter turn's 1.
  double sum = -1 / 25852016738884976640000.0;  // 23!
  sum = sum * s + 1 / 51090942171709440000.0;
  sum = sum * s - 1 / 121645100408832000.0;
  sum = sum * s + 1 / 355687428096000.0;
  sum = sum * s - 1 / 1307674368000.0;
  sum = sum * s + 1 / 6227020800.0;
  sum = sum * s - 1 / 39916800.0;
  sum = sum * s + 1 / 362880.0;
  sum = sum * s - 1 / 5040.0;
  sum = sum * s + 1 / 120.0;
  sum = sum * s - 1 / 6.0;
  return a + a * s * sum;
}

inline double cos_of_turns(double turns) noexcept { return sin_of_turns(turns + 0.25); }

}  // namespace tet::scene
