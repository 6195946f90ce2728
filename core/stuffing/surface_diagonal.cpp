#include "core/stuffing/surface_diagonal.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace tet {
namespace {

struct Vector {
  double x, y, z;
};

Vector from_to(const WorldPoint& a, const WorldPoint& b) noexcept {
  return {b.x - a.x, b.y - a.y, b.z - a.z};
}
Vector cross(const Vector& u, const Vector& v) noexcept {
  return {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
}
double dot(const Vector& u, const Vector& v) noexcept {
  return u.x * v.x + u.y * v.y + u.z * v.z;
}

/// Largest squared cosine of a tet's dihedral angles: 1 for a flat one.
double worst_square_of_cosine(const WorldPoint& a,
                              const WorldPoint& b,
                              const WorldPoint& c,
                              const WorldPoint& d) noexcept {
  const Vector ab = from_to(a, b), ac = from_to(a, c), ad = from_to(a, d);
  const std::array<Vector, 4> normal{cross(from_to(b, d), from_to(b, c)), cross(ac, ad),
                                     cross(ad, ab), cross(ab, ac)};
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

bool second_diagonal_is_better(const WorldPoint& apex,
                               const WorldPoint& a,
                               const WorldPoint& b,
                               const WorldPoint& c,
                               const WorldPoint& d) noexcept {
  const double first =
      std::max(worst_square_of_cosine(apex, a, b, c), worst_square_of_cosine(apex, a, c, d));
  const double second =
      std::max(worst_square_of_cosine(apex, b, c, d), worst_square_of_cosine(apex, b, d, a));
  return second < first;
}

}  // namespace tet
