// Triangle surfaces of solids whose volume is known, and ways to spoil them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/types.h"
#include "core/surface/triangle_surface.h"

namespace tet::test {

/// A box, wound outwards.
TriangleSurface box_surface(const WorldPoint& low, const WorldPoint& high);

/// A sphere of 2 * rings * rings triangles, wound outwards.
TriangleSurface sphere_surface(const WorldPoint& centre, double radius, int rings = 24);

/// Blocks between the planes of three axes, some of them full; index (i * ny + j) * nz + k.
/// The surface is what lies between a full block and an empty one, wound outwards.
struct Blocks {
  std::array<std::vector<double>, 3> planes;
  std::vector<std::uint8_t> full;

  bool is_full(std::ptrdiff_t i, std::ptrdiff_t j, std::ptrdiff_t k) const;
  double volume() const;
  TriangleSurface surface() const;
};

/// A box of walls, with a channel of `neck` through the middle of its top: a bottle.
Blocks bottle(double outer, double wall, double neck);

TriangleSurface joined(const TriangleSurface& a, const TriangleSurface& b);
TriangleSurface inside_out(TriangleSurface surface);
/// Without `count` triangles from `first` on.
TriangleSurface without(TriangleSurface surface, std::size_t first, std::size_t count);
/// Every triangle with three vertices of its own.
TriangleSurface torn(const TriangleSurface& surface);
/// scale * p + offset.
TriangleSurface placed(TriangleSurface surface, double scale, const WorldPoint& offset);
/// Turned about an axis that is none of the three, about the origin.
TriangleSurface rotated(TriangleSurface surface, double radians);

/// The volume of a polyhedron that is closed and wound outwards.
double volume_of(const TriangleSurface& surface);

}  // namespace tet::test
