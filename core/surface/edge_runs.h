// The edges of a surface, and the triangles at each.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/surface/triangle_surface.h"

namespace tet {

/// A side of a triangle.
struct SurfaceSide {
  std::uint32_t low = 0, high = 0;  ///< its vertices
  std::uint32_t triangle = 0;
  bool upwards = false;  ///< the triangle passes it from low to high

  friend auto operator<=>(const SurfaceSide&, const SurfaceSide&) = default;
};

/// All sides, sorted: those at one edge are a run, by triangle.
std::vector<SurfaceSide> sorted_sides(const TriangleSurface& surface);

/// Calls `visit(run)` for the sides at each edge.
template <class Visit>
void for_each_edge(std::span<const SurfaceSide> sides, const Visit& visit) {
  for (std::size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
    while (end < sides.size() && sides[end].low == sides[begin].low &&
           sides[end].high == sides[begin].high) {
      ++end;
    }
    visit(sides.subspan(begin, end - begin));
  }
}

}  // namespace tet
