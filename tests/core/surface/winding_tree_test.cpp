#include "core/surface/winding_tree.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "core/base/parallel.h"
#include "tests/support/random_surfaces.h"
#include "tests/support/surfaces.h"

namespace tet {
namespace {

std::vector<WorldPoint> points_around(const TriangleSurface& surface, std::uint64_t seed) {
  WorldPoint low = surface.vertices[0], high = low;
  for (const WorldPoint& p : surface.vertices) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  std::mt19937_64 dice(seed);
  const auto between = [&](double a, double b) {
    const double t = std::ldexp(static_cast<double>(dice() >> 11), -53);
    return a + (b - a) * (1.4 * t - 0.2);
  };
  std::vector<WorldPoint> points;
  for (int i = 0; i < 200; ++i) {
    points.push_back({between(low.x, high.x), between(low.y, high.y), between(low.z, high.z)});
  }
  return points;
}

TEST(WindingTree, AgreesWithTheSumOverAllTriangles) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const test::RandomSurface made = test::random_surface(seed);
    const WindingTree tree(made.surface);
    for (const WorldPoint& p : points_around(made.surface, seed)) {
      EXPECT_NEAR(tree.at(p), exact_winding_number(made.surface, p), 0.04)
          << made.what << ", seed " << seed;
    }
  }
}

TEST(WindingTree, CountsTheSolidsThatHoldAPoint) {
  const auto two =
      test::joined(test::sphere_surface({}, 1, 64), test::sphere_surface({}, 2, 64));
  const WindingTree tree(two);
  EXPECT_NEAR(tree.at({0.1, 0.2, 0.3}), 2, 0.04);
  EXPECT_NEAR(tree.at({1.5, 0.2, 0.3}), 1, 0.04);
  EXPECT_NEAR(tree.at({2.5, 0.2, 0.3}), 0, 0.04);
  const WindingTree hollow(test::joined(test::inside_out(test::sphere_surface({}, 1, 64)),
                                        test::sphere_surface({}, 2, 64)));
  EXPECT_NEAR(hollow.at({0.1, 0.2, 0.3}), 0, 0.04);
}

TEST(WindingTree, IsAHalfOnAFaceWhicheverSideTheFaceIsLookedAtFrom) {
  const auto box = test::box_surface({0, 0, 0}, {2, 2, 2});
  for (const auto& surface : {box, test::rotated(test::rotated(box, 0.3), -0.3)}) {
    EXPECT_NEAR(exact_winding_number(box, {1, 0.5, 0}), 0.5, 1e-9);
    EXPECT_NEAR(WindingTree(surface).at({1, 1, 1}), 1, 1e-9);
  }
  // On the diagonal that two triangles share, and where two boxes touch.
  EXPECT_NEAR(exact_winding_number(box, {1, 1, 0}), 0.5, 1e-9);
  const auto touching = test::joined(box, test::box_surface({2, -1, -1}, {4, 3, 3}));
  EXPECT_NEAR(exact_winding_number(touching, {2, 0.7, 0.9}), 1, 1e-9);
}

TEST(WindingTree, IsTheSameForAnyNumberOfThreads) {
  const auto surface = test::sphere_surface({}, 1, 80);
  const auto points = points_around(surface, 1);
  std::vector<std::vector<double>> numbers;
  for (const int threads : {1, 4}) {
    TaskPool pool(threads);
    pool.run([&] {
      const WindingTree tree(surface);
      auto& found = numbers.emplace_back();
      for (const WorldPoint& p : points) found.push_back(tree.at(p));
    });
  }
  EXPECT_EQ(numbers[0], numbers[1]);
}

TEST(WindingTree, IsNowhereWithoutTriangles) { EXPECT_EQ(WindingTree({}).at({1, 2, 3}), 0); }

}  // namespace
}  // namespace tet
