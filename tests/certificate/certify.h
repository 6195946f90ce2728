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
  /// Give up after this many boxes: the bound holds then too, but is worse than it could be.
  std::size_t max_boxes = 20'000'000;
};

struct Certified {
  double bound_deg = 0;     ///< proven, rounded to the safe side to 0.001
  double attained_deg = 0;  ///< about the worst angle seen at a single point
  std::size_t boxes = 0;
};

/// Bounds every angle of every tet of the problems. Deterministic.
Certified certify(std::span<const Problem> problems, const Goal& goal);

/// How far angles turn when all corners of their tets move by up to some displacement.
struct CertifiedTurn {
  double bound_deg = kInfinity;  ///< proven, whatever the angle is; infinite: nothing is
  double attained_deg = 0;       ///< about the fastest that was seen at a single point
  std::size_t boxes = 0;
};

/// Proves that no angle of any tet of the problems turns by more than `enough_deg`, wherever
/// their parameters are: their orders are not looked at. `displacement` is in spacings. Gives
/// up after `max_boxes` boxes. Deterministic.
CertifiedTurn certify_turn(std::span<const Problem> problems,
                           double displacement,
                           double enough_deg,
                           std::size_t max_boxes);

}  // namespace tet::certificate
