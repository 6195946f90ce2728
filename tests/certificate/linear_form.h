// A function over a box by its value in the middle and its slopes all over the box, and how
// much it can be there at most.
#pragma once

#include <array>
#include <cstddef>

#include "tests/certificate/interval.h"
#include "tests/certificate/problem.h"

namespace tet::certificate {

/// Values of the parameters.
using Box = std::array<Interval, kParameters>;

double middle_of(const Interval& range);
Box middle_of(const Box& box);

/// f(t) = middle + sum over k of slope_k (t_k - m_k), m the middle of the box: by the mean
/// value theorem for some slopes within the intervals.
struct LinearForm {
  Interval middle;
  std::array<Interval, kParameters> slope{};

  LinearForm plus(const LinearForm& other, double weight) const;
};

/// f <= this over the box.
double upper_bound(const LinearForm& f, const Box& box);

/// Adds to `f` the multiple of `g` that lowers its upper bound the most. Where g >= 0, the sum
/// is no less than f, so that its bound is one of f there.
void lower_where_not_negative(LinearForm& f, const LinearForm& g, const Box& box);

}  // namespace tet::certificate
