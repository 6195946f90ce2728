#include "core/mesh/triangle_distance.h"

#include <algorithm>

#include "core/base/tet_geometry.h"

namespace tet {
namespace {

double to_side(const WorldPoint& p, const WorldPoint& a, const WorldPoint& b) noexcept {
  const Vector side = from_to(a, b), way = from_to(a, p);
  const double square = dot(side, side);
  const double share = square > 0 ? std::clamp(dot(way, side) / square, 0.0, 1.0) : 0;
  const Vector off{way.x - share * side.x, way.y - share * side.y, way.z - share * side.z};
  return dot(off, off);
}

}  // namespace

double squared_distance(const WorldPoint& p, const std::array<WorldPoint, 3>& t) noexcept {
  const auto& [a, b, c] = t;
  const Vector ab = from_to(a, b), ac = from_to(a, c), ap = from_to(a, p);
  const Vector normal = cross(ab, ac);
  const double square = dot(normal, normal);
  if (square > 0) {
    // Where p lies above the triangle.
    const double v = dot(cross(ap, ac), normal), w = dot(cross(ab, ap), normal);
    if (v >= 0 && w >= 0 && v + w <= square) {
      const double height = dot(ap, normal);
      return height * height / square;
    }
  }
  return std::min({to_side(p, a, b), to_side(p, b, c), to_side(p, c, a)});
}

}  // namespace tet
