#include <algorithm>
#include <cstdlib>
#include <vector>

#include "tests/certificate/certify.h"
#include "tests/certificate/dihedral.h"

namespace tet::certificate {
namespace {

/// How much edges change along a parameter of a box, together.
double change_in(const Tet& tet, const Box& box, std::size_t k) {
  int change = 0;
  for (std::size_t i = 0; i < tet.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        change += std::abs(tet[i].along[k][axis] - tet[j].along[k][axis]);
      }
    }
  }
  return change * (box[k].upper() - box[k].lower());
}

class TurnSearch {
 public:
  TurnSearch(double displacement, double enough_deg, std::size_t max_boxes)
      : displacement_(displacement * kSpacing),
        enough_(enough_deg * kRadians),
        max_boxes_(max_boxes) {}

  void bound(const Problem& problem) {
    Box whole;
    for (std::size_t k = 0; k < problem.parameter_count; ++k) {
      whole[k] = Interval(problem.slide[k].range.low, problem.slide[k].range.high);
    }
    for (const Tet& tet : problem.tets) {
      for (std::size_t angle = 0; angle < kAngles; ++angle) {
        bound(tet, angle, whole, problem.parameter_count);
      }
    }
  }

  bool proven() const { return boxes_ < max_boxes_; }
  double attained_deg() const { return seen_ / kRadians; }
  std::size_t boxes() const { return boxes_; }

 private:
  /// A little less than those of a degree, so that what is proven is a little more.
  static constexpr double kRadians = 3.14159265 / 180;

  /// By the mean value theorem along the straight way of the corners, on which the faces at the
  /// angle keep an area.
  double turn(const Tet& tet, std::size_t angle, const Box& box, double blur) const {
    const Interval speed = enclose_sensitivity(tet, angle, box, blur);
    return (speed * Interval(displacement_)).upper();
  }

  void bound(const Tet& tet, std::size_t angle, const Box& whole, std::size_t parameters) {
    std::vector<Box> open{whole};
    while (!open.empty() && boxes_ < max_boxes_) {
      ++boxes_;
      const Box box = open.back();
      open.pop_back();
      if (turn(tet, angle, box, displacement_) <= enough_) continue;
      seen_ = std::max(seen_, turn(tet, angle, middle_of(box), 0));
      std::size_t widest = 0;
      for (std::size_t k = 1; k < parameters; ++k) {
        if (change_in(tet, box, k) > change_in(tet, box, widest)) widest = k;
      }
      const double middle = middle_of(box[widest]);
      open.push_back(box);
      open.back()[widest] = Interval(box[widest].lower(), middle);
      open.push_back(box);
      open.back()[widest] = Interval(middle, box[widest].upper());
    }
  }

  const double displacement_, enough_;
  const std::size_t max_boxes_;
  double seen_ = 0;
  std::size_t boxes_ = 0;
};

}  // namespace

CertifiedTurn certify_turn(std::span<const Problem> problems,
                           double displacement,
                           double enough_deg,
                           std::size_t max_boxes) {
  const RoundUpward upward;
  TurnSearch search(displacement, enough_deg, max_boxes);
  for (const Problem& problem : problems) search.bound(problem);
  return {search.proven() ? enough_deg : kInfinity, search.attained_deg(), search.boxes()};
}

}  // namespace tet::certificate
