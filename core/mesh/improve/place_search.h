// The search for a place where the tets around a vertex have better angles.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/base/tet_geometry.h"
#include "core/base/types.h"
#include "core/mesh/improve/star.h"

namespace tet {

/// What a search begins with; lengths are those of stored positions.
struct PlaceWanted {
  WorldPoint start;
  WorldPoint home;  ///< from which the vertex may go `reach`
  double leaf = 0;  ///< edge of the leaves around the vertex
  double reach = 0;
  AngleRange before;  ///< angles of the star at `start`
  AngleRange limit;   ///< angles that are good, or no worse than the mesh's own
};

/// Searches a star for places that cost less. `Guide` says where the vertex may go:
/// `along(way)` is what of a way leads there, and `settle(ahead)` the place there, as it is
/// stored, that is nearest to one ahead, or nothing.
template <class Guide>
class PlaceSearch {
 public:
  PlaceSearch(Star& star, const AngleGoal& goal, Guide& guide) noexcept
      : star_(star), goal_(goal), guide_(guide) {}

  /// Whether there is a better place: every tet of the star stays positive, the costliest gets
  /// cheaper, and no angle passes all of the star's own, unless it is within the limit.
  bool run(const PlaceWanted& wanted) {
    wanted_ = wanted;
    place_ = wanted.start;
    bound_.range = {
        std::max(wanted.before.largest_cosine, wanted.limit.largest_cosine) - kRounding,
        std::min(wanted.before.smallest_cosine, wanted.limit.smallest_cosine) + kRounding};
    bound_.cost = goal_.cost(wanted.before) - kLeastGain;
    double step = kFirstStep;
    while (!good() && step >= kLastStep) {
      if (!go_downhill(step) && !go_anywhere(step)) step /= 2;
    }
    return !(place_ == wanted.start);
  }

  const WorldPoint& place() const noexcept { return place_; }
  /// Whether the star meets the goal at the place.
  bool good() const noexcept { return bound_.cost <= goal_.good_cost(); }

 private:
  // Steps in leaves. Bunny, torus and gyroid end within a tenth of a degree of the same angles
  // with a first step of 0.08 to 0.3 and a last one of 0.005; half a degree lower with one of
  // 0.05.
  static constexpr double kFirstStep = 0.15, kLastStep = 0.02;
  /// Over which a cost is differentiated, in leaves.
  static constexpr double kDifference = 1e-3;
  /// A cost must fall by this, about a hundredth of a degree: what is worth a move.
  static constexpr double kLeastGain = 1e-4;
  /// Hides that a star adds an angle up in another order than whoever measures the mesh.
  static constexpr double kRounding = 1e-9;

  /// Towards the faces and corners of a cube, so that any direction is near one of them.
  static std::array<Vector, 14> ways_to_go() {
    const double s = 1 / std::sqrt(3.0);
    return {{{1, 0, 0},
             {0, 1, 0},
             {0, 0, 1},
             {-1, 0, 0},
             {0, -1, 0},
             {0, 0, -1},
             {s, s, s},
             {s, s, -s},
             {s, -s, s},
             {s, -s, -s},
             {-s, s, s},
             {-s, s, -s},
             {-s, -s, s},
             {-s, -s, -s}}};
  }

  static double length(const Vector& v) noexcept { return std::sqrt(dot(v, v)); }

  /// Down the slope of the worst tet, as far as it leads.
  bool go_downhill(double step) {
    star_.angles(place_);
    const Vector way = guide_.along(star_.descent(place_, kDifference * wanted_.leaf));
    bool gone = false;
    while (go(way, step)) gone = true;
    return gone;
  }

  bool go_anywhere(double step) {
    static const std::array<Vector, 14> ways = ways_to_go();
    return std::any_of(ways.begin(), ways.end(),
                       [&](const Vector& way) { return go(guide_.along(way), step); });
  }

  bool go(const Vector& way, double step) {
    const double far = length(way);
    if (!(far > 0) || good()) return false;
    const double scale = step * wanted_.leaf / far;
    const std::optional<WorldPoint> place = guide_.settle(
        {place_.x + scale * way.x, place_.y + scale * way.y, place_.z + scale * way.z});
    if (!place || length(from_to(wanted_.home, *place)) > wanted_.reach) return false;
    const std::optional<double> cost = star_.cost_below(bound_, *place);
    if (!cost) return false;
    bound_.cost = *cost - kLeastGain;
    place_ = *place;
    return true;
  }

  Star& star_;
  const AngleGoal& goal_;
  Guide& guide_;
  PlaceWanted wanted_;
  WorldPoint place_;
  StarBound bound_;
};

}  // namespace tet
