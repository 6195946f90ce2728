// Branch and bound: the least and greatest dihedral angle of a set of problems, proven.
#pragma once

#include <cstddef>
#include <span>

#include "tests/certificate/interval.h"
#include "tests/certificate/problem.h"

namespace tet::certificate {

/// Which end of the angles to bound.
enum class Extreme { kLeast, kGreatest };

struct Goal {
  Extreme extreme = Extreme::kLeast;
  /// How far from its place a corner may lie, in units of the lattice's spacing.
  double displacement = 0;
  /// Stop where the bound is proven to be as good as this; 0 to get as near to the worst angle
  /// as the tolerance asks.
  double enough_deg = 0;
  double tolerance_deg = 0.005;
  /// With `enough_deg`: look at single points too, which takes about as long again, for
  /// `attained_deg`; and stop where one of them is worse than enough, as nothing proves it
  /// then. Without, it is their worst that says when a bound is near enough.
  bool refute = true;
  /// Give up after this many boxes: the bound holds then too, but is worse than it could be.
  std::size_t max_boxes = 20'000'000;
};

struct Certified {
  double bound_deg = 0;  ///< proven, rounded to the safe side to 0.001
  double attained_deg =
      0;  ///< about the worst angle seen at a single point, if any was looked at
  std::size_t boxes = 0;
};

/// Bounds every angle of every tet of the problems. Deterministic.
Certified certify(std::span<const Problem> problems, const Goal& goal);

/// How far an angle turns at most, degrees, when the corners of its tet move by up to
/// `displacement` and its two faces are at least `width` wide, which is their least height;
/// both in spacings. Infinite where they may lose their area on the way.
///
/// A corner that moves by x turns its face by x / h, h its height above the angle's edge, and
/// the ends of the edge turn it by x |1 - lambda| / h and x |lambda| / h, where lambda says how
/// far along the edge the foot of the corner lies. The three add up to 2 / h where the foot is
/// on the edge. Where it is beyond an end they are 2 cot / e: cot of the acute angle of the
/// face at the other end, e the edge's length; and that is less than twice the inverse of
/// another height of the face. So both faces together turn by no more than 4 x / width; on the
/// way the width loses 2 x at most.
double greatest_turn_deg(double width, double displacement);

}  // namespace tet::certificate
