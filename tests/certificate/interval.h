// Outward-rounded interval arithmetic, and angles in degrees by their cotangent.
#pragma once

#include <array>
#include <limits>

#include <boost/numeric/interval.hpp>

namespace tet::certificate {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// An interval of reals with double ends. Arithmetic encloses every exact result, but only
/// while a `RoundUpward` lives on the thread.
using Interval =
    boost::numeric::interval_lib::unprotect<boost::numeric::interval<double>>::type;

/// Makes the processor round upward while it lives; Interval rounds down by negation.
using RoundUpward = boost::numeric::interval<double>::traits_type::rounding;

using IntervalVector = std::array<Interval, 3>;

inline Interval dot(const IntervalVector& u, const IntervalVector& v) {
  return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

inline Interval squared_length(const IntervalVector& u) {
  return square(u[0]) + square(u[1]) + square(u[2]);
}

inline IntervalVector cross(const IntervalVector& u, const IntervalVector& v) {
  return {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
}

inline IntervalVector operator-(const IntervalVector& u, const IntervalVector& v) {
  return {u[0] - v[0], u[1] - v[1], u[2] - v[2]};
}

/// Encloses the cotangent of an angle in degrees, 0 < degrees < 180.
Interval cotangent_of(double degrees);

/// Largest multiple of 0.001 degrees proven to be no more than the angle of `cotangent`.
double degrees_below(double cotangent);

/// Smallest multiple of 0.001 degrees proven to be no less than the angle of `cotangent`.
double degrees_above(double cotangent);

/// The angle of a cotangent, 0..180, to about 1e-13: for what is printed or compared, never for
/// what is proven.
double about_degrees(double cotangent);

}  // namespace tet::certificate
