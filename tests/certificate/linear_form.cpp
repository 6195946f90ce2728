#include "tests/certificate/linear_form.h"

#include <algorithm>
#include <cmath>

namespace tet::certificate {

double middle_of(const Interval& range) {
  return std::min(range.lower() + 0.5 * (range.upper() - range.lower()), range.upper());
}

Box middle_of(const Box& box) {
  Box middle;
  for (std::size_t k = 0; k < kParameters; ++k) middle[k] = Interval(middle_of(box[k]));
  return middle;
}

LinearForm LinearForm::plus(const LinearForm& other, double weight) const {
  LinearForm sum{middle + Interval(weight) * other.middle, {}};
  for (std::size_t k = 0; k < kParameters; ++k) {
    sum.slope[k] = slope[k] + Interval(weight) * other.slope[k];
  }
  return sum;
}

double upper_bound(const LinearForm& f, const Box& box) {
  Interval sum = f.middle;
  for (std::size_t k = 0; k < kParameters; ++k) {
    if (box[k].lower() == box[k].upper()) continue;
    sum += f.slope[k] * (box[k] - Interval(middle_of(box[k])));
  }
  return sum.upper();
}

void lower_where_not_negative(LinearForm& f, const LinearForm& g, const Box& box) {
  const LinearForm given = f;
  double best = upper_bound(f, box);
  // The bound of f + weight g is convex in the weight, with bends where a slope is zero.
  for (std::size_t k = 0; k < kParameters; ++k) {
    const double weight = -middle_of(given.slope[k]) / middle_of(g.slope[k]);
    if (!(weight > 0) || !std::isfinite(weight)) continue;
    const LinearForm sum = given.plus(g, weight);
    if (const double bound = upper_bound(sum, box); bound < best) {
      best = bound;
      f = sum;
    }
  }
}

}  // namespace tet::certificate
