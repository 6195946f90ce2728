#include "core/labels/label_cost.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "core/base/tet_geometry.h"

namespace tet {
namespace {

double square_of_cosine(double degrees) noexcept {
  const double cosine = std::cos(degrees * std::numbers::pi / 180);
  return cosine * cosine;
}

/// The greatest angle is weighed so that both limits cost the same: whatever is best is good if
/// anything is.
const double kObtuseCost = square_of_cosine(kGoodLeast) / square_of_cosine(kGoodGreatest);

double squared_distance(const WorldPoint& a, const WorldPoint& b) noexcept {
  const Vector way = from_to(a, b);
  return dot(way, way);
}

}  // namespace

const double kGoodCost = square_of_cosine(kGoodLeast);

double tet_cost(const WorldPoint& a,
                const WorldPoint& b,
                const WorldPoint& c,
                const WorldPoint& d) noexcept {
  const std::array<Vector, 4> normal = face_normals(a, b, c, d);
  if (!(dot(from_to(a, b), normal[1]) > 0)) return kNeverTaken;
  std::array<double, 4> square;
  for (std::size_t i = 0; i < 4; ++i) square[i] = dot(normal[i], normal[i]);
  double worst = -1;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = i + 1; j < 4; ++j) {
      const double product = dot(normal[i], normal[j]);  // minus the cosine, times the areas
      const double cosine = product * std::abs(product) / (square[i] * square[j]);
      worst = std::max({worst, -cosine, kObtuseCost * cosine});
    }
  }
  if (worst > kGoodCost) return worst;
  // A triangle's width is its least height: twice its area by its longest edge.
  const double ab = squared_distance(a, b), ac = squared_distance(a, c),
               ad = squared_distance(a, d), bc = squared_distance(b, c),
               bd = squared_distance(b, d), cd = squared_distance(c, d);
  const std::array<double, 4> longest{std::max({bc, bd, cd}), std::max({ac, ad, cd}),
                                      std::max({ab, ad, bd}), std::max({ab, ac, bc})};
  for (std::size_t i = 0; i < 4; ++i) {
    if (square[i] < kLeastWidth * kLeastWidth * longest[i]) return kNeverTaken;
  }
  return worst;
}

}  // namespace tet
