// How far a point is from a triangle.
#pragma once

#include <array>

#include "core/base/types.h"

namespace tet {

/// The square of the distance; a triangle without area is a line, or a point.
double squared_distance(const WorldPoint& p, const std::array<WorldPoint, 3>& t) noexcept;

}  // namespace tet
