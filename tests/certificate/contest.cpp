#include "tests/certificate/contest.h"

#include <algorithm>
#include <limits>

#include "tests/certificate/dihedral.h"

namespace tet::certificate {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The mesher compares in double; its |cot| are off by far less than this part of them.
constexpr double kRounding = 1e-6;

}  // namespace

std::vector<Contest::Angle> Contest::angles_of(const std::vector<Tet>& tets, const Box& box) {
  std::vector<Angle> angles;
  const Box middle = middle_of(box);
  for (const Tet& tet : tets) {
    for (std::size_t i = 0; i < kAngles; ++i) {
      const Dihedral over_box = enclose_dihedral(tet, i, box, 0);
      if (!over_box.positive) {
        angles.push_back({{}, 0, kInfinity, false});
        continue;
      }
      LinearForm form{enclose_cotangent(tet, i, middle), over_box.slope};
      const LinearForm opposite = LinearForm{}.plus(form, -1);
      const double high = std::min(over_box.cotangent.upper(), upper_bound(form, box));
      const double low = std::max(over_box.cotangent.lower(), -upper_bound(opposite, box));
      if (low > 0) {
        angles.push_back({form, low, high, true});
      } else if (high < 0) {
        angles.push_back({opposite, -high, -low, true});
      } else {
        angles.push_back({{}, 0, std::max(high, -low), false});
      }
    }
  }
  return angles;
}

Contest::Contest(const Problem& problem, const Box& box)
    : box_(box),
      contender_(angles_of(problem.contender, box)),
      rival_(angles_of(problem.rival, box)) {
  for (const Angle& angle : contender_) contender_low_ = std::max(contender_low_, angle.low);
  for (const Angle& angle : rival_) {
    rival_low_ = std::max(rival_low_, angle.low);
    rival_high_ = std::max(rival_high_, angle.high);
  }
}

double Contest::limit() const {
  return (Interval(rival_high_) * Interval(1 + kRounding)).upper();
}

bool Contest::lost() const { return contender_low_ > limit(); }

// Where the contender is taken, any one of its angles, such as the worst in the middle, is no
// worse than the rival's worst, whichever that is.
double Contest::bound(const LinearForm& f) const {
  const auto worst = std::max_element(
      contender_.begin(), contender_.end(), [](const Angle& a, const Angle& b) {
        return a.signed_surely < b.signed_surely ||
               (a.signed_surely && b.signed_surely &&
                a.badness.middle.upper() < b.badness.middle.upper());
      });
  if (!worst->signed_surely) return kInfinity;
  double most = -kInfinity;
  for (const Angle& angle : rival_) {
    if (angle.high < rival_low_) continue;  // never the worst
    if (!angle.signed_surely) return kInfinity;
    LinearForm better = LinearForm{}.plus(angle.badness, 1 + kRounding);
    better = better.plus(worst->badness, -1);
    LinearForm bounded = f;
    lower_where_not_negative(bounded, better, box_);
    most = std::max(most, upper_bound(bounded, box_));
  }
  return most;
}

}  // namespace tet::certificate
