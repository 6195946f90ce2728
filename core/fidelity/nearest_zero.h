// How far a point is from the zero surface of phi.
#pragma once

#include <optional>

#include "core/base/types.h"
#include "core/field/world_phi.h"

namespace tet {

/// Finds the foot of a point on the surface. Not thread-safe: one per task.
class NearestZero {
 public:
  /// `spacing`: of the lattice, world units; what is near is told by it.
  NearestZero(const PhiField& field, double spacing)
      : phi_(field, kStep * spacing), spacing_(spacing) {}

  /// The distance from `p` to a point of the surface that is the nearest around it: down the
  /// slope of phi first, then along the surface until it is straight below `p`. Nothing where
  /// phi has no slope to follow, or the slope leads nowhere.
  std::optional<double> distance(const WorldPoint& p) noexcept;

  double phi_at(const WorldPoint& p) noexcept { return phi_.at(p); }

 private:
  static constexpr double kStep = 1e-4;   ///< of a scene's slope, in spacings
  static constexpr double kClose = 1e-4;  ///< to the surface, in spacings
  static constexpr double kReach = 8;     ///< of one step, in spacings

  std::optional<WorldPoint> descend(WorldPoint from, int steps) noexcept;

  WorldPhi phi_;
  double spacing_;
};

}  // namespace tet
