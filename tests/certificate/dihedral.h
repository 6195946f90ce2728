// One dihedral angle of a tet whose corners slide, enclosed over a box of their parameters.
#pragma once

#include <array>
#include <cstddef>

#include "tests/certificate/linear_form.h"
#include "tests/certificate/problem.h"

namespace tet::certificate {

inline constexpr std::size_t kAngles = 6;

/// Cotangent of the dihedral angle, with what it takes to bound it over a box.
struct Dihedral {
  bool positive = false;  ///< the tet is positive all over the box; else nothing is known
  Interval cotangent;
  std::array<Interval, kParameters> slope;  ///< its derivatives
  /// Sum over the corners of the length of the angle's gradient, in radians a unit: how fast it
  /// changes at most when all of them move. Known if `blur` is not 0.
  Interval sensitivity;
};

/// Angle `angle` (in the order of kTetEdge) of `tet` over `box`. The corners may lie up to
/// `blur` away from their places along each axis.
Dihedral enclose_dihedral(const Tet& tet, std::size_t angle, const Box& box, double blur);

/// Its cotangent alone; anything where the tet may not be positive.
Interval enclose_cotangent(const Tet& tet, std::size_t angle, const Box& box);

/// Dihedral::sensitivity alone. It hangs on the two faces at the angle and not on the volume;
/// it is infinite where one of them may have no area.
Interval enclose_sensitivity(const Tet& tet, std::size_t angle, const Box& box, double blur);

/// Dihedral::sensitivity alone, and infinite where the tet may not be positive, too.
Interval enclose_positive_sensitivity(const Tet& tet,
                                      std::size_t angle,
                                      const Box& box,
                                      double blur);

}  // namespace tet::certificate
