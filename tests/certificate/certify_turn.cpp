#include "tests/certificate/certify.h"

namespace tet::certificate {

double greatest_turn_deg(double width, double displacement) {
  const RoundUpward upward;
  const Interval moved(displacement);
  const Interval left = Interval(width) - Interval(2) * moved;
  if (!(left.lower() > 0)) return kInfinity;
  constexpr double kLessThanADegree = 3.14159265 / 180;  // radians
  return (Interval(4) * moved / left / Interval(kLessThanADegree)).upper();
}

}  // namespace tet::certificate
