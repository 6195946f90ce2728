#include "core/stuffing/surface_diagonal.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <random>
#include <span>

#include <gtest/gtest.h>

#include "core/base/tet_geometry.h"

namespace tet {
namespace {

/// One tet's worst angle by itself, number by number.
double worst_angle_of(const std::array<WorldPoint, 4>& at) {
  const std::array<Vector, 4> normal = face_normals(at[0], at[1], at[2], at[3]);
  double worst = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = i + 1; j < 4; ++j) {
      const double cosine = dot(normal[i], normal[j]);
      const double squares = dot(normal[i], normal[i]) * dot(normal[j], normal[j]);
      worst = std::max(worst, (cosine > 0 ? kObtuseWeight : 1) * (cosine * cosine / squares));
    }
  }
  return worst;
}

bool second_is_better_by_itself(std::span<const WorldPoint> apexes,
                                const std::array<WorldPoint, 4>& quad) {
  const auto [a, b, c, d] = quad;
  double first = 0, second = 0;
  for (const WorldPoint& apex : apexes) {
    first = std::max({first, worst_angle_of({apex, a, b, c}), worst_angle_of({apex, a, c, d})});
    second =
        std::max({second, worst_angle_of({apex, b, c, d}), worst_angle_of({apex, b, d, a})});
  }
  return second < first;
}

TEST(SurfaceDiagonal, IsWhatTheFourTetsSayOneByOne) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> off(-0.3, 0.3);
  std::size_t second = 0;
  for (int i = 0; i < 10000; ++i) {
    const auto near = [&](double x, double y, double z) {
      return WorldPoint{x + off(random), y + off(random), z + off(random)};
    };
    const std::array<WorldPoint, 2> apexes{near(0, 0, 1), near(0, 0, -1)};
    const std::array<WorldPoint, 4> quad{near(-1, -1, 0), near(1, -1, 0), near(1, 1, 0),
                                         near(-1, 1, 0)};
    for (const std::size_t count : {std::size_t{1}, std::size_t{2}}) {
      const std::span used = std::span(apexes).first(count);
      const bool better = second_diagonal_is_better(used, quad[0], quad[1], quad[2], quad[3]);
      EXPECT_EQ(better, second_is_better_by_itself(used, quad));
      second += better ? 1 : 0;
    }
  }
  EXPECT_GT(second, 5000U);
  EXPECT_LT(second, 15000U);
}

TEST(SurfaceDiagonal, KeepsTheFirstOfEqualOnes) {
  const std::array<WorldPoint, 2> apexes{WorldPoint{0, 0, 1}, WorldPoint{0, 0, -1}};
  EXPECT_FALSE(
      second_diagonal_is_better(apexes, {-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}));
}

}  // namespace
}  // namespace tet
