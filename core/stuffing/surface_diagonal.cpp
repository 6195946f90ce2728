#include "core/stuffing/surface_diagonal.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "core/base/tet_geometry.h"

namespace tet {
namespace {

/// Largest squared cosine of a tet's dihedral angles: 1 for a flat one.
double worst_square_of_cosine(const WorldPoint& a,
                              const WorldPoint& b,
                              const WorldPoint& c,
                              const WorldPoint& d) noexcept {
  const std::array<Vector, 4> normal = face_normals(a, b, c, d);
  std::array<double, 4> square;
  for (std::size_t i = 0; i < 4; ++i) square[i] = dot(normal[i], normal[i]);
  double worst = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = i + 1; j < 4; ++j) {
      const double cosine = dot(normal[i], normal[j]);
      worst = std::max(worst, cosine * cosine / (square[i] * square[j]));
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
    first = std::max(
        {first, worst_square_of_cosine(apex, a, b, c), worst_square_of_cosine(apex, a, c, d)});
    second = std::max(
        {second, worst_square_of_cosine(apex, b, c, d), worst_square_of_cosine(apex, b, d, a)});
  }
  return second < first;
}

}  // namespace tet
