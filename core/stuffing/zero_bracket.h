// A zero of phi along an edge, closed in on step by step by whoever evaluates phi.
#pragma once

#include <cmath>

namespace tet {

/// How far a cut point may be from a zero of the field it is looked for in, in edges.
inline constexpr double kZeroTolerance = 1e-6;

/// A bracket around one zero in [0, 1]: `x` was tried last, phi has the other sign at `other`,
/// and `old` was given up.
///
/// Begins with the zero of the line between the ends, and goes on with Chandrupatla's steps
/// (Adv. Eng. Software 28, 1997): inverse quadratic where that is safe, else halves.
///
/// Both ways are computed, and one is taken: columns of brackets are narrowed as vectors.
struct ZeroBracket {
  double x = 0, f = 0, other = 1, f_other = 0, old = 0, f_old = 0;
  double next = 0;  ///< to be tried
  bool done = false;

  /// Halving twice for each bit of the tolerance is the worst case.
  static constexpr int kMaxSteps = 64;

  /// phi at both ends, of strictly opposite signs.
  void begin(double at_0, double at_1) noexcept {
    f = at_0;
    f_other = at_1;
    next = between(at_0 / (at_0 - at_1), kShortest, 1 - kShortest);
  }

  /// phi is `value` at `next`.
  void narrow(double value) noexcept {
    take(value);
    find_next();
  }

  /// The two halves of `narrow`: a bracket that is done needs no second one.
  void take(double value) noexcept {
    const bool same_side = (value < 0) == (f < 0);
    old = same_side ? x : other;
    f_old = same_side ? f : f_other;
    other = same_side ? other : x;
    f_other = same_side ? f_other : f;
    x = next;
    f = value;
    done = (f == 0) | (nearest() > 0.5);
  }
  void find_next() noexcept {
    const double least = nearest() < 0.5 ? nearest() : 0.5;
    next = x + between(step(), least, 1 - least) * (other - x);
  }

  double zero() const noexcept { return std::abs(f) < std::abs(f_other) ? x : other; }

 private:
  /// Steps end this near to each end of a bracket at most.
  static constexpr double kShortest = kZeroTolerance / 2;

  /// Never nearer to an end than the tolerance, as a part of the width: the last step lands
  /// beyond the zero.
  double nearest() const noexcept { return kShortest / std::abs(other - x); }

  static double between(double value, double low, double high) noexcept {
    const double at_least = value < low ? low : value;
    return high < at_least ? high : at_least;
  }

  /// The next point, as a part of the way from x to the other end.
  double step() const noexcept {
    const double xi = (x - other) / (old - other), phi = (f - f_other) / (f_old - f_other);
    const double quadratic =
        f / (f_other - f) * f_old / (f_other - f_old) +
        (old - x) / (other - x) * f / (f_old - f) * f_other / (f_old - f_other);
    return ((phi * phi < xi) & ((1 - phi) * (1 - phi) < 1 - xi)) ? quadratic : 0.5;
  }
};

}  // namespace tet
