#include "core/stuffing/surface_diagonal.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "core/base/tet_geometry.h"

namespace tet {
namespace {

/// Largest weighted square of the cosines of a tet's dihedral angles.
double worst_angle(const WorldPoint& a,
                   const WorldPoint& b,
                   const WorldPoint& c,
                   const WorldPoint& d) noexcept {
  const std::array<Vector, 4> normal = face_normals(a, b, c, d);
  std::array<double, 4> square;
  for (std::size_t i = 0; i < 4; ++i) square[i] = dot(normal[i], normal[i]);
  double worst = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = i + 1; j < 4; ++j) {
      const double cosine = dot(normal[i], normal[j]);  // times -1, and the areas
      const double weight = cosine > 0 ? kObtuseWeight : 1;
      worst = std::max(worst, weight * (cosine * cosine / (square[i] * square[j])));
    }
  }
  return worst;
}

}  // namespace

bool second_diagonal_is_better(std::span<const WorldPoint> apexes,
                               const WorldPoint& a,
                               const WorldPoint& b,
                               const WorldPoint& c,
                               const WorldPoint& d) noexcept {
  double first = 0, second = 0;
  for (const WorldPoint& apex : apexes) {
    first = std::max({first, worst_angle(apex, a, b, c), worst_angle(apex, a, c, d)});
    second = std::max({second, worst_angle(apex, b, c, d), worst_angle(apex, b, d, a)});
  }
  return second < first;
}

}  // namespace tet
