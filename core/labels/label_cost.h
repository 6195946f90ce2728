// How bad a tet's angles are, and whether it is too thin for them to be kept by rounding.
#pragma once

#include <limits>

#include "core/base/types.h"

namespace tet {

/// A tet is good if all its angles, in degrees, lie between these and no face is narrower than
/// kLeastWidth, in spacings: then no angle turns by more than 2.5 degrees when positions are
/// rounded to float32 (docs/bounds.md), which leaves the bounds of both sides.
inline constexpr double kGoodLeast = 12.0, kGoodGreatest = 148.5;
inline constexpr double kLeastWidth = 0.04;

/// What a tet costs that is exactly good.
extern const double kGoodCost;
/// The cost of a tet that is not positive, or not good but for its angles.
inline constexpr double kNeverTaken = std::numeric_limits<double>::infinity();

/// The larger of cos^2 of the least angle and the weighted one of the greatest, both with the
/// sign of what is bad; no more than kGoodCost if and only if the tet a, b, c, d is good.
/// Places are in spacings.
double tet_cost(const WorldPoint& a,
                const WorldPoint& b,
                const WorldPoint& c,
                const WorldPoint& d) noexcept;

}  // namespace tet
