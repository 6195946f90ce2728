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
/// takes too many looks at its corners gets a fan: more than tens of thousands for each corner,
/// and the `spare_looks` beyond that, from which those that it took are taken. Convex polygons
/// get the fan of their first corner.
std::vector<std::array<std::uint32_t, 3>> triangulate_polygon(
    std::span<const WorldPoint> points, std::uint64_t& spare_looks);

/// What the polygons of one file have together: about ten seconds of a processor, where a
/// decoder has 90 for a file. A band of five corners a turn that winds itself up takes as many
/// when it has 5,000 corners.
inline constexpr std::uint64_t kSpareLooks = std::uint64_t{1} << 31;

}  // namespace tet
