// Vertices that lie at one place become one.
#pragma once

#include <cstdint>
#include <vector>

#include "core/surface/triangle_surface.h"

namespace tet {

/// Maps each vertex to the first of those that have its coordinates.
std::vector<std::uint32_t> weld_equal(const std::vector<WorldPoint>& vertices);

/// Maps each vertex in `among` to the first of those there that are no farther than `tolerance`
/// on each axis, in one step or in several; some up to twice as far count, too. The others stay
/// as they are in `first`, which is the result's size.
std::vector<std::uint32_t> weld_near(const std::vector<WorldPoint>& vertices,
                                     const std::vector<std::uint32_t>& among,
                                     double tolerance,
                                     std::vector<std::uint32_t> first);

}  // namespace tet
