#include "tests/certificate/certify.h"

#include <algorithm>
#include <cstdlib>
#include <queue>
#include <vector>

#include "tests/certificate/contest.h"
#include "tests/certificate/dihedral.h"

namespace tet::certificate {
namespace {

/// One angle of one tet over a box. Its badness is sign * cot: cot for the least angle, -cot
/// for the greatest.
struct Node {
  double bound = kInfinity;  ///< no badness in the box is larger
  std::uint32_t problem = 0;
  std::uint8_t tet = 0, angle = 0;
  std::uint8_t split_at = 0;  ///< the parameter whose range is halved next
  Box box;
};

struct LessBound {
  bool operator()(const Node& a, const Node& b) const { return a.bound < b.bound; }
};

/// The badness of an angle that is `turn` radians nearer to its end than one of badness
/// `value`.
double turned(double value, double turn) {
  if (value == kInfinity || !(turn < 0.5)) return kInfinity;
  // tan(x) <= x + x^3 for 0 <= x < 1/2.
  const Interval tangent = Interval(turn) + Interval(turn) * square(Interval(turn));
  const Interval denominator = Interval(1) - Interval(value) * tangent;
  if (!(denominator.lower() > 0)) return kInfinity;
  return ((Interval(value) + tangent) / denominator).upper();
}

/// t_longer - t_shorter >= -slack may not hold all over the box.
bool active(const ColumnOrder& order, const Box& box) {
  return !(box[order.longer].lower() >= box[order.shorter].upper());
}

bool in_active_order(const Problem& problem, const Box& box, std::size_t k) {
  return std::any_of(problem.orders.begin(), problem.orders.end(),
                     [&](const ColumnOrder& order) {
                       return (order.longer == k || order.shorter == k) && active(order, box);
                     });
}

/// Shrinks a box to where the orders can hold; false where nothing is left.
bool meet_orders(const Problem& problem, Box& box) {
  for (const auto& [longer, shorter] : problem.orders) {
    Interval &i = box[longer], &j = box[shorter];
    const double low = std::max(i.lower(), (j - Interval(kTieSlack)).lower());
    const double high = std::min(j.upper(), (i + Interval(kTieSlack)).upper());
    if (low > i.upper() || high < j.lower()) return false;
    i = Interval(low, i.upper());
    j = Interval(j.lower(), high);
  }
  return true;
}

class Search {
 public:
  Search(std::span<const Problem> problems, const Goal& goal)
      : problems_(problems),
        goal_(goal),
        sign_(goal.extreme == Extreme::kLeast ? 1 : -1),
        displacement_(goal.displacement * kSpacing) {}

  Certified run() {
    if (goal_.enough_deg > 0) enough_ = badness(cotangent_of(goal_.enough_deg)).lower();
    push_roots();
    while (!queue_.empty() && boxes_ < goal_.max_boxes && !is_refuted()) {
      const Node node = queue_.top();
      queue_.pop();
      if (!done_with(node)) split(node);
    }
    if (!queue_.empty()) proven_ = std::max(proven_, queue_.top().bound);
    return {sign_ > 0 ? degrees_below(proven_) : degrees_above(-proven_),
            about_degrees(sign_ * seen_), boxes_};
  }

 private:
  bool looks_at_points() const { return goal_.refute || !(goal_.enough_deg > 0); }
  /// Some point is worse than what was to be proven.
  bool is_refuted() const { return goal_.enough_deg > 0 && seen_ > enough_; }

  const Problem& problem_of(const Node& node) const { return problems_[node.problem]; }
  const Tet& tet_of(const Node& node) const { return problem_of(node).tets[node.tet]; }
  Interval badness(const Interval& cotangent) const {
    return sign_ > 0 ? cotangent : -cotangent;
  }

  void push_roots() {
    for (std::uint32_t p = 0; p < problems_.size(); ++p) {
      Node node;
      node.problem = p;
      for (std::size_t k = 0; k < problems_[p].parameter_count; ++k) {
        const Range& range = problems_[p].slide[k].range;
        node.box[k] = Interval(range.low, range.high);
      }
      for (node.tet = 0; node.tet < problems_[p].tets.size(); ++node.tet) {
        for (node.angle = 0; node.angle < kAngles; ++node.angle) push(node);
      }
    }
  }

  void split(const Node& node) {
    const std::size_t k = node.split_at;
    const double middle = middle_of(node.box[k]);
    Node low = node, high = node;
    low.box[k] = Interval(node.box[k].lower(), middle);
    high.box[k] = Interval(middle, node.box[k].upper());
    push(low);
    push(high);
  }

  /// How far corners go along a parameter, together: it says how much a volume hangs on it.
  static double reach_of(const Tet& tet, std::size_t k) {
    double reach = 0;
    for (const Corner& corner : tet) {
      int most = 0;
      for (const int along : corner.along[k]) most = std::max(most, std::abs(along));
      reach += most;
    }
    return reach;
  }

  /// The widest one, measured by how much the angle changes along it; where there is no bound
  /// yet, by how far corners go along it. Who wins a contest may depend on any of them.
  std::uint8_t parameter_to_split(const Node& node, const Dihedral& over_box) const {
    constexpr double kLeastSlope = 1;
    const bool by_slope = node.bound < kInfinity && problem_of(node).rival.empty();
    std::uint8_t best = 0;
    double most = -1;
    for (std::uint8_t k = 0; k < problem_of(node).parameter_count; ++k) {
      const double slope = by_slope ? boost::numeric::norm(over_box.slope[k]) + kLeastSlope
                           : problem_of(node).rival.empty() ? reach_of(tet_of(node), k)
                                                            : 1;
      const double change = (node.box[k].upper() - node.box[k].lower()) * slope;
      if (change > most) {
        most = change;
        best = k;
      }
    }
    return best;
  }

  /// Keeps a part of a box for later, if there is more to find out about it.
  void push(Node node) {
    ++boxes_;
    if (!meet_orders(problem_of(node), node.box) || !bound(node)) return;
    if (!done_with(node)) queue_.push(node);
  }

  bool done_with(const Node& node) {
    if (node.bound > enough_) return false;
    proven_ = std::max(proven_, node.bound);
    return true;
  }

  /// Lowers the node's bound to what holds in its box; false where the tet is not emitted.
  bool bound(Node& node) {
    Dihedral over_box = enclose_dihedral(tet_of(node), node.angle, node.box, 0);
    constexpr int kRounds = 3;
    for (int round = 0; round < kRounds && fix_monotone(node, over_box); ++round) {
      over_box = enclose_dihedral(tet_of(node), node.angle, node.box, 0);
    }
    if (looks_at_points()) look_at_worst_corner(node, over_box);
    if (over_box.positive && !lower_bound_of(node, over_box)) return false;
    node.split_at = parameter_to_split(node, over_box);
    return true;
  }

  /// Lowers the bound of a node whose tet is positive all over its box.
  bool lower_bound_of(Node& node, const Dihedral& over_box) {
    const LinearForm form = linear_form(node, over_box);
    double value = std::min(badness(over_box.cotangent).upper(), upper_bound(form, node.box));
    const double turn = turn_of(node);
    if (!problem_of(node).rival.empty() && displaced(value, turn) > enough_) {
      const Contest contest(problem_of(node), node.box);
      if (contest.lost()) return false;
      value = std::min({value, contest.limit(sign_ < 0), contest.bound(form)});
    }
    node.bound = std::min(node.bound, displaced(value, turn));
    return true;
  }

  /// Puts parameters along which the badness only grows to their upper ends, and the reverse:
  /// the worst is there. Not where that could leave what the orders or a contest allow, or
  /// where the displacement counts, which need not be worst there.
  bool fix_monotone(Node& node, const Dihedral& over_box) const {
    const Problem& problem = problem_of(node);
    if (!over_box.positive || displacement_ != 0 || !problem.rival.empty()) return false;
    bool fixed = false;
    for (std::size_t k = 0; k < problem.parameter_count; ++k) {
      Interval& t = node.box[k];
      if (t.lower() == t.upper() || in_active_order(problem, node.box, k)) continue;
      const Interval slope = badness(over_box.slope[k]);
      if (slope.lower() < 0 && slope.upper() > 0) continue;
      t = Interval(slope.lower() >= 0 ? t.upper() : t.lower());
      fixed = true;
    }
    return fixed;
  }

  LinearForm linear_form(const Node& node, const Dihedral& over_box) const {
    const Box middle = middle_of(node.box);
    LinearForm form{badness(enclose_cotangent(tet_of(node), node.angle, middle)), {}};
    for (std::size_t k = 0; k < kParameters; ++k) form.slope[k] = badness(over_box.slope[k]);
    for (const ColumnOrder& order : problem_of(node).orders) {
      if (!active(order, node.box)) continue;
      LinearForm longer_by{middle[order.longer] - middle[order.shorter] + Interval(kTieSlack),
                           {}};
      longer_by.slope[order.longer] = Interval(1);
      longer_by.slope[order.shorter] = Interval(-1);
      lower_where_not_negative(form, longer_by, node.box);
    }
    return form;
  }

  /// How many radians an angle in the box turns at most when every corner moves by up to the
  /// displacement.
  double turn_of(const Node& node) const {
    if (displacement_ == 0) return 0;
    const Interval sensitivity =
        enclose_positive_sensitivity(tet_of(node), node.angle, node.box, displacement_);
    return (sensitivity * Interval(displacement_)).upper();
  }

  /// A badness after its angle turned so far.
  double displaced(double value, double turn) const {
    return displacement_ == 0 ? value : turned(value, turn);
  }

  /// Evaluates the badness where its slopes lead, to know how far the bound can still fall.
  void look_at_worst_corner(const Node& node, const Dihedral& over_box) {
    const Problem& problem = problem_of(node);
    Node point = node;
    for (std::size_t k = 0; k < problem.parameter_count; ++k) {
      const Interval& t = node.box[k];
      const double slope = over_box.positive ? middle_of(badness(over_box.slope[k])) : 0;
      point.box[k] = Interval(slope > 0 ? t.upper() : slope < 0 ? t.lower() : middle_of(t));
    }
    for (const auto& [longer, shorter] : problem.orders) {
      if (point.box[longer].lower() >= point.box[shorter].lower()) continue;
      const double t = std::min(point.box[shorter].lower(), problem.slide[longer].range.high);
      if (t < problem.slide[shorter].range.low) return;
      point.box[longer] = point.box[shorter] = Interval(t);
    }
    for (const ColumnOrder& order : problem.orders) {
      if (active(order, point.box)) return;
    }
    if (!problem.rival.empty() && Contest(problem, point.box).lost()) return;
    const double value =
        badness(enclose_cotangent(tet_of(node), node.angle, point.box)).lower();
    if (value > -kInfinity) note_seen(displaced(value, turn_of(point)));
  }

  /// What is no worse than the worst seen, but for the tolerance, needs no closer look.
  void note_seen(double value) {
    if (value <= seen_) return;
    seen_ = value;
    if (goal_.enough_deg > 0) return;
    const double degrees = about_degrees(sign_ * seen_) - sign_ * goal_.tolerance_deg;
    enough_ = badness(cotangent_of(degrees)).lower();
  }

  std::span<const Problem> problems_;
  Goal goal_;
  int sign_;
  double displacement_;
  std::priority_queue<Node, std::vector<Node>, LessBound> queue_;
  double enough_ = -kInfinity;  ///< boxes with this bound or less are done with
  double proven_ = -kInfinity;  ///< the largest bound of those
  double seen_ = -kInfinity;    ///< the worst at single points
  std::size_t boxes_ = 0;
};

}  // namespace

Certified certify(std::span<const Problem> problems, const Goal& goal) {
  const RoundUpward upward;
  return Search(problems, goal).run();
}

}  // namespace tet::certificate
