#include "tests/certificate/interval.h"

#include <cfenv>
#include <cmath>
#include <numbers>

namespace tet::certificate {
namespace {

struct SineCosine {
  Interval sine, cosine;
};

/// Taylor's series for |x| <= pi/2: the terms alternate and fall from the second on, so each is
/// more than all that is left out.
SineCosine sine_cosine(const Interval& x) {
  constexpr int kTerms = 34;
  SineCosine sum{Interval(0), Interval(0)};
  Interval term(1);
  for (int n = 0; n < kTerms; ++n) {
    Interval& of = n % 2 == 0 ? sum.cosine : sum.sine;
    of = n % 4 < 2 ? of + term : of - term;
    term = term * x / Interval(n + 1);
  }
  const double left_out = 2 * boost::numeric::norm(term);
  sum.sine += Interval(-left_out, left_out);
  sum.cosine += Interval(-left_out, left_out);
  return sum;
}

constexpr double kStep = 1000;    // of printed angles, a degree
constexpr double kNearly = 1e-6;  // so that 11.3 is not taken for 11.299

/// Converts steps to degrees as they are written in decimals, whatever the rounding mode.
double degrees_of(double steps) {
  const int mode = std::fegetround();
  std::fesetround(FE_TONEAREST);
  const volatile double degrees = steps / kStep;
  std::fesetround(mode);
  return degrees;
}

}  // namespace

Interval cotangent_of(double degrees) {
  const Interval pi = boost::numeric::interval_lib::pi<Interval>();
  // cot(a) = tan(90 degrees - a) keeps the argument of the series small.
  const auto [sine, cosine] =
      sine_cosine((Interval(90) - Interval(degrees)) * pi / Interval(180));
  return sine / cosine;
}

double about_degrees(double cotangent) {
  return 90 - std::atan(cotangent) * 180 / std::numbers::pi;
}

double degrees_below(double cotangent) {
  double steps = std::floor(about_degrees(cotangent) * kStep + kNearly);
  while (steps > 0 && !(cotangent_of(degrees_of(steps)).lower() >= cotangent)) --steps;
  return degrees_of(steps);
}

double degrees_above(double cotangent) {
  double steps = std::ceil(about_degrees(cotangent) * kStep - kNearly);
  while (steps < 180 * kStep && !(cotangent_of(degrees_of(steps)).upper() <= cotangent))
    ++steps;
  return degrees_of(steps);
}

}  // namespace tet::certificate
