#include "core/surface/outer_surface.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/tet_geometry.h"
#include "core/surface/cut_triangle.h"
#include "tests/support/surfaces.h"

namespace tet {
namespace {

using ::testing::HasSubstr;

Vector doubled_area(const CutTriangle& t) {
  return cross(from_to(t[0], t[1]), from_to(t[0], t[2]));
}

double longest_of(const CutTriangle& t) {
  double longest = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector side = from_to(t[i], t[(i + 1) % 3]);
    longest = std::max(longest, std::sqrt(dot(side, side)));
  }
  return longest;
}

/// Checks that pieces of a triangle are short, wound as it is and have its area; returns how
/// many there are for what area and length ask for.
double check_pieces(const CutTriangle& triangle, double edge) {
  const Vector whole = doubled_area(triangle);
  const double area = std::sqrt(dot(whole, whole));
  const Vector normal{whole.x / area, whole.y / area, whole.z / area};
  double sum = 0, longest = 0, least = 0;
  std::size_t count = 0;
  TriangleCutter(edge).for_each_piece(triangle, [&](const CutTriangle& piece) {
    ++count;
    longest = std::max(longest, longest_of(piece));
    const double part = dot(doubled_area(piece), normal);
    sum += part;
    least = std::min(least, part);
  });
  EXPECT_NEAR(sum / area, 1, 1e-9);
  EXPECT_LE(longest, edge * (1 + 1e-9));
  EXPECT_GE(least, -1e-9 * area);
  EXPECT_GE(static_cast<double>(count), TriangleCutter(edge).least_pieces(triangle));
  const double length = longest_of(triangle) / edge;
  return static_cast<double>(count) / (area / 2 / (edge * edge) + length + 1);
}

TEST(TriangleCutter, MakesAsFewPiecesAsAreaAndLengthAskFor) {
  // Halves of the third one would be 40,000,000.
  EXPECT_LT(check_pieces({{{0, 0, 0}, {100, 0, 0}, {30, 80, 0}}}, 1), 10);
  EXPECT_LT(check_pieces({{{0, 0, 0}, {100, 0, 0}, {100, 7, 0}}}, 1), 10);
  EXPECT_LT(check_pieces({{{0, 0, 0}, {50'000, 0, 0}, {20'000, 0.1, 0}}}, 1), 3);
  EXPECT_LT(check_pieces({{{0, 0, 0}, {50'000, 0, 0}, {50'000, 20, 0}}}, 1), 10);
}

TEST(TriangleCutter, CoversAnyTriangleOnce) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any(-1, 1);
  for (int i = 0; i < 300; ++i) {
    const auto place = [&](double size) {
      return WorldPoint{size * any(random), size * any(random), size * any(random)};
    };
    const WorldPoint a = place(100), b = place(100), off = place(std::pow(10, 2 * any(random)));
    const double part = 0.5 + 0.6 * any(random);
    const WorldPoint c{a.x + part * (b.x - a.x) + off.x, a.y + part * (b.y - a.y) + off.y,
                       a.z + part * (b.z - a.z) + off.z};
    EXPECT_LT(check_pieces({a, b, c}, 1), 20) << i;
  }
}

TEST(TriangleCutter, CutsANeedleWhoseTipIsBesideItsEnd) {
  for (const double top : {0.0, 1e-12, 0.25, 0.5, 1 - 1e-12, 1.0}) {
    check_pieces({{{0, 0, 0}, {64, 0, 0}, {64 * top, 1e-3, 0}}}, 1);
    check_pieces({{{0, 0, 0}, {640, 0, 0}, {640 * top, 3, 0}}}, 1);
  }
}

TEST(TriangleCutter, HalvesLongestSidesOfAllButNeedles) {
  const CutTriangle triangle{{{0, 0, 0}, {3, 0, 0}, {1, 2, 1}}};
  std::vector<CutTriangle> halves{triangle}, pieces;
  while (!halves.empty()) {
    const CutTriangle t = halves.back();
    halves.pop_back();
    if (longest_of(t) <= 1) {
      pieces.push_back(t);
      continue;
    }
    std::size_t longest = 0;
    const auto squared = [&](std::size_t i) {
      const Vector side = from_to(t[i], t[(i + 1) % 3]);
      return dot(side, side);
    };
    for (std::size_t i = 1; i < 3; ++i) {
      if (squared(i) > squared(longest)) longest = i;
    }
    const WorldPoint &a = t[longest], &b = t[(longest + 1) % 3], &c = t[(longest + 2) % 3];
    const WorldPoint half{a.x + 0.5 * (b.x - a.x), a.y + 0.5 * (b.y - a.y),
                          a.z + 0.5 * (b.z - a.z)};
    halves.push_back({half, b, c});
    halves.push_back({a, half, c});
  }
  std::size_t next = 0;
  TriangleCutter(1).for_each_piece(triangle, [&](const CutTriangle& piece) {
    ASSERT_LT(next, pieces.size());
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(piece[i].x, pieces[next][i].x);
      EXPECT_EQ(piece[i].y, pieces[next][i].y);
      EXPECT_EQ(piece[i].z, pieces[next][i].z);
    }
    ++next;
  });
  EXPECT_EQ(next, pieces.size());
}

TEST(OuterSurface, OfBarsThatCrossIsThatOfTheirUnion) {
  const auto bars = test::joined(test::box_surface({-2000, -0.2, -0.2}, {2000, 0.2, 0.2}),
                                 test::box_surface({-0.2, -2000, -0.2}, {0.2, 2000, 0.2}));
  const auto outer = outer_surface(bars, WindingTree(bars), 1, 1'000'000);
  ASSERT_TRUE(outer.ok()) << outer.status();
  EXPECT_LT(outer->triangles.size(), 150'000U);
  // But for the pieces at the crossing it has the volume of both.
  EXPECT_NEAR(test::volume_of(*outer), 2 * 4000 * 0.16, 1);
}

TEST(OuterSurface, IsRefusedWhereItWouldTakeTooManyPieces) {
  const auto box = test::box_surface({0, 0, 0}, {1e6, 0.5, 0.5});
  const absl::Status refused = outer_surface(box, WindingTree(box), 1, 100'000).status();
  EXPECT_EQ(refused.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(refused.message(), HasSubstr("e+06 pieces of 1 voxels; the limit is 1e+05"));
  EXPECT_THAT(refused.message(), HasSubstr("Use larger voxels"));
  EXPECT_TRUE(outer_surface(box, WindingTree(box), 1000, 100'000).ok());
}

}  // namespace
}  // namespace tet
