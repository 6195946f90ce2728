#include "core/mesh/triangle_distance.h"

#include <cmath>

#include <gtest/gtest.h>

namespace tet {
namespace {

using Place = std::array<WorldPoint, 3>;
const Place kTriangle{{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}}};

TEST(TriangleDistance, IsTheHeightAboveTheTriangle) {
  EXPECT_DOUBLE_EQ(squared_distance({0.5, 0.5, 3}, kTriangle), 9);
  EXPECT_DOUBLE_EQ(squared_distance({0.5, 0.5, -3}, kTriangle), 9);
  EXPECT_DOUBLE_EQ(squared_distance({0.25, 0.25, 0}, kTriangle), 0);
}

TEST(TriangleDistance, IsTheWayToTheNearestSideOrCornerElsewhere) {
  EXPECT_DOUBLE_EQ(squared_distance({1, -2, 0}, kTriangle), 4);
  EXPECT_DOUBLE_EQ(squared_distance({-3, -4, 0}, kTriangle), 25);
  EXPECT_DOUBLE_EQ(squared_distance({2, 2, 1}, kTriangle), 3);
}

TEST(TriangleDistance, OfATriangleWithoutAreaIsThatOfALineOrAPoint) {
  EXPECT_DOUBLE_EQ(squared_distance({1, 1, 0}, {{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}}), 1);
  EXPECT_DOUBLE_EQ(squared_distance({0, 3, 4}, {{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}}), 25);
}

}  // namespace
}  // namespace tet
