// Polygons, concave ones among them, become triangles.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/types.h"

namespace tet {

/// Cuts a polygon with these corners into triangles that are wound as it is, two less than it
/// has corners; ids are places in `points`.
///
/// Ears are cut off, as seen along the polygon's mean normal: those whose triangle holds no
/// other corner. A polygon that crosses itself, has no area, or is so tangled that finding ears
/// takes more than tens of thousands of looks for each corner gets a fan. Convex polygons get
/// the fan of their first corner.
std::vector<std::array<std::uint32_t, 3>> triangulate_polygon(
    std::span<const WorldPoint> points);

}  // namespace tet
