// Holes of a surface, and triangles that close them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/surface/edge_runs.h"
#include "core/surface/triangle_surface.h"

namespace tet {

/// A closed path along edges that triangles pass more often one way than the other, that way.
using HoleLoop = std::vector<std::uint32_t>;

/// All such edges as loops that meet no vertex twice, each edge as often as it lacks a partner.
///
/// Whatever the triangles are, there is a way out of a vertex for each way in, so the loops
/// always close. They are found in the order of the vertices.
std::vector<HoleLoop> find_holes(std::span<const SurfaceSide> sides);

/// Adds a cap to each loop: one triangle to a loop of three, else a fan around the loop's
/// middle, a new vertex. Then every edge is passed as often one way as the other.
void add_caps(std::span<const HoleLoop> holes, TriangleSurface& surface);

}  // namespace tet
