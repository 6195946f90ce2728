#include "tests/certificate/contest.h"

#include <algorithm>

#include "core/stuffing/surface_diagonal.h"
#include "tests/certificate/dihedral.h"

namespace tet::certificate {
namespace {

/// The mesher compares in double; its squared cosines are off by far less than this part.
constexpr double kRounding = 1e-6;
constexpr double kWithRounding = 1 + kRounding;

Interval squared_cosine(const Interval& cotangent) {
  return Interval(1) - Interval(1) / (Interval(1) + square(cotangent));
}

double lower_bound(const LinearForm& f, const Box& box) {
  return -upper_bound(LinearForm{}.plus(f, -1), box);
}

}  // namespace

Contest::Angle Contest::angle_of(const Tet& tet,
                                 std::size_t angle,
                                 const Box& box,
                                 const Box& middle) {
  const Dihedral over_box = enclose_dihedral(tet, angle, box, 0);
  if (!over_box.positive) return {{}, 0, kInfinity, false};
  const LinearForm cotangent{enclose_cotangent(tet, angle, middle), over_box.slope};
  const Interval range = intersect(
      over_box.cotangent, Interval(lower_bound(cotangent, box), upper_bound(cotangent, box)));
  Angle out;
  out.one_sided = range.lower() > 0 || range.upper() < 0;
  const Interval weight(range.upper() < 0 ? kObtuseWeight : 1,
                        range.lower() > 0 ? 1 : kObtuseWeight);
  const Interval badness = weight * squared_cosine(range);
  out.low = badness.lower();
  out.high = badness.upper();
  if (!out.one_sided) return out;
  out.badness.middle = weight * squared_cosine(cotangent.middle);
  const Interval growth = weight * Interval(2) * range / square(Interval(1) + square(range));
  for (std::size_t k = 0; k < kParameters; ++k) {
    out.badness.slope[k] = growth * over_box.slope[k];
  }
  out.low = std::max(out.low, lower_bound(out.badness, box));
  out.high = std::min(out.high, upper_bound(out.badness, box));
  return out;
}

std::vector<Contest::Angle> Contest::angles_of(const std::vector<Tet>& tets, const Box& box) {
  std::vector<Angle> angles;
  const Box middle = middle_of(box);
  for (const Tet& tet : tets) {
    for (std::size_t i = 0; i < kAngles; ++i) angles.push_back(angle_of(tet, i, box, middle));
  }
  return angles;
}

Contest::Contest(const Problem& problem, const Box& box)
    : box_(box),
      contender_(angles_of(problem.contender, box)),
      rival_(angles_of(problem.rival, box)) {
  for (const Angle& angle : contender_) contender_low_ = std::max(contender_low_, angle.low);
  double rival_high = 0;
  for (const Angle& angle : rival_) {
    rival_low_ = std::max(rival_low_, angle.low);
    rival_high = std::max(rival_high, angle.high);
  }
  limit_ = (Interval(rival_high) * Interval(kWithRounding)).upper();
}

bool Contest::lost() const { return contender_low_ > limit_; }

double Contest::limit(bool obtuse) const {
  const Interval cosine2 = Interval(limit_) / (obtuse ? Interval(kObtuseWeight) : Interval(1));
  const Interval sine2 = Interval(1) - cosine2;
  if (!(sine2.lower() > 0)) return kInfinity;
  return sqrt(cosine2 / sine2).upper();
}

// Where the contender is taken, any one of its angles, such as the worst in the middle, is no
// worse than the rival's worst, whichever that is.
double Contest::bound(const LinearForm& f) const {
  const auto worst = std::max_element(
      contender_.begin(), contender_.end(), [](const Angle& a, const Angle& b) {
        return a.one_sided < b.one_sided ||
               (a.one_sided && b.one_sided &&
                a.badness.middle.upper() < b.badness.middle.upper());
      });
  if (!worst->one_sided) return kInfinity;
  double most = -kInfinity;
  for (const Angle& angle : rival_) {
    if (angle.high < rival_low_) continue;  // never the worst
    if (!angle.one_sided) return kInfinity;
    LinearForm better = LinearForm{}.plus(angle.badness, kWithRounding);
    better = better.plus(worst->badness, -1);
    LinearForm bounded = f;
    lower_where_not_negative(bounded, better, box_);
    most = std::max(most, upper_bound(bounded, box_));
  }
  return most;
}

}  // namespace tet::certificate
