// Which of two surface diagonals is taken, over a box: the one whose worst angle is better.
#pragma once

#include <vector>

#include "tests/certificate/linear_form.h"
#include "tests/certificate/problem.h"

namespace tet::certificate {

/// The worst angles of a problem's contender and rival, each by its |cot|: the further an angle
/// is from 90 degrees, the larger are both |cot| and the cos^2 by which the mesher compares.
class Contest {
 public:
  Contest(const Problem& problem, const Box& box);

  /// The rival is better all over the box: the contender's tets are not emitted.
  bool lost() const;

  /// Where the contender is taken, none of its angles has a larger |cot| than this.
  double limit() const;

  /// An upper bound of `f` over that part of the box where the contender is taken.
  double bound(const LinearForm& f) const;

 private:
  struct Angle {
    LinearForm badness;  ///< |cot|, if its sign is known
    double low, high;    ///< of |cot|
    bool signed_surely;
  };
  static std::vector<Angle> angles_of(const std::vector<Tet>& tets, const Box& box);

  Box box_;
  std::vector<Angle> contender_, rival_;
  double contender_low_ = 0, rival_low_ = 0, rival_high_ = 0;
};

}  // namespace tet::certificate
