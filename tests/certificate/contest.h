// Which of two surface diagonals is taken, over a box: the one whose worst angle is better.
#pragma once

#include <vector>

#include "tests/certificate/linear_form.h"
#include "tests/certificate/problem.h"

namespace tet::certificate {

/// The angles of a problem's contender and rival by their badness, as the mesher compares them:
/// their squared cosine, that of obtuse ones weighted.
class Contest {
 public:
  Contest(const Problem& problem, const Box& box);

  /// The rival is better all over the box: the contender's tets are not emitted.
  bool lost() const;

  /// Where the contender is taken, none of its acute, or obtuse, angles has a larger |cot| than
  /// this.
  double limit(bool obtuse) const;

  /// An upper bound of `f` over that part of the box where the contender is taken.
  double bound(const LinearForm& f) const;

 private:
  struct Angle {
    LinearForm badness;  ///< if it is known on which side of 90 degrees the angle is
    double low = 0, high = 0;
    bool one_sided = false;
  };
  static std::vector<Angle> angles_of(const std::vector<Tet>& tets, const Box& box);
  static Angle angle_of(const Tet& tet, std::size_t angle, const Box& box, const Box& middle);

  Box box_;
  std::vector<Angle> contender_, rival_;
  double contender_low_ = 0, rival_low_ = 0;
  double limit_ = 0;  ///< the contender's badness where it is taken
};

}  // namespace tet::certificate
