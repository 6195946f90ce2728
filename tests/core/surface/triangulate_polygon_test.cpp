#include "core/surface/triangulate_polygon.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <gtest/gtest.h>

#include "core/base/tet_geometry.h"
#include "core/base/thread_time.h"
#include "tests/support/sanitized.h"

namespace tet {
namespace {

/// Cuts a polygon that is its file's only one.
std::vector<std::array<std::uint32_t, 3>> triangles_of(std::span<const WorldPoint> polygon) {
  std::uint64_t spare_looks = kSpareLooks;
  return triangulate_polygon(polygon, spare_looks);
}

/// Sums of the triangles' areas: as they are wound along the polygon's own normal, and without
/// their signs.
struct Areas {
  double wound = 0, all = 0;
};

Areas areas_of(const std::vector<WorldPoint>& polygon) {
  Areas areas;
  for (const auto& [a, b, c] : triangles_of(polygon)) {
    const Vector n = cross(from_to(polygon[a], polygon[b]), from_to(polygon[a], polygon[c]));
    areas.wound += n.z / 2;
    areas.all += std::abs(n.z) / 2;
  }
  return areas;
}

std::vector<WorldPoint> turned_by(std::vector<WorldPoint> polygon, std::size_t first) {
  std::rotate(polygon.begin(), polygon.begin() + static_cast<std::ptrdiff_t>(first),
              polygon.end());
  return polygon;
}

TEST(TriangulatePolygon, CoversConcavePolygonsOnceWhereverTheyBegin) {
  const std::vector<WorldPoint> l{{0, 0, 0}, {3, 0, 0}, {3, 1, 0},
                                  {1, 1, 0}, {1, 3, 0}, {0, 3, 0}};
  std::vector<WorldPoint> comb{{0, -1, 0}, {20, -1, 0}};
  for (int i = 20; i >= 0; --i) comb.push_back({1.0 * i, i % 2 == 0 ? 0.0 : 5.0, 0});
  std::vector<WorldPoint> star;
  for (int i = 0; i < 14; ++i) {
    const double r = i % 2 == 0 ? 3 : 1, angle = M_PI * i / 7;
    star.push_back({r * std::cos(angle), r * std::sin(angle), 0.1 * std::sin(5 * angle)});
  }
  for (const auto& polygon : {l, comb, star}) {
    double area = 0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const WorldPoint &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
      area += (p.x * q.y - q.x * p.y) / 2;
    }
    for (std::size_t first = 0; first < polygon.size(); ++first) {
      auto from_there = turned_by(polygon, first);
      EXPECT_EQ(triangles_of(from_there).size(), polygon.size() - 2);
      EXPECT_NEAR(areas_of(from_there).wound, area, 1e-9);
      EXPECT_NEAR(areas_of(from_there).all, area, 1e-9);
      std::reverse(from_there.begin(), from_there.end());
      EXPECT_NEAR(areas_of(from_there).wound, -area, 1e-9);
      EXPECT_NEAR(areas_of(from_there).all, area, 1e-9);
    }
  }
}

TEST(TriangulatePolygon, FansConvexPolygonsAndWhatIsNone) {
  using Triangles = std::vector<std::array<std::uint32_t, 3>>;
  const std::vector<WorldPoint> square{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  EXPECT_EQ(triangles_of(square), (Triangles{{0, 1, 2}, {0, 2, 3}}));
  const std::vector<WorldPoint> line{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}};
  EXPECT_EQ(triangles_of(line).size(), 2U);
  const std::vector<WorldPoint> bow{{0, 0, 0}, {2, 2, 0}, {2, 0, 0}, {0, 3, 0}};
  EXPECT_EQ(triangles_of(bow).size(), 2U);
  EXPECT_TRUE(triangles_of(std::span(square).first(2)).empty());
  EXPECT_TRUE(triangles_of({}).empty());
}

/// A polygon that crosses itself, with ears that are found one by one: between two of them all
/// of its `teeth` are looked at, and of each all other corners before the one that lies in it.
std::vector<WorldPoint> tangled(int teeth) {
  const double long_way = 1000;
  std::vector<WorldPoint> polygon;
  for (int i = 0; i < teeth; ++i) {
    polygon.push_back({0, 1.0 * i, 0});
    polygon.push_back({long_way, i + 0.5, 0});
  }
  polygon.push_back({0, 1.0 * teeth, 0});
  polygon.push_back({-10 * long_way, 1.0 * teeth, 0});
  polygon.push_back({-10 * long_way, -1, 0});
  for (int i = -1; i < teeth; ++i) {
    const double part = 1.0 * i / teeth;
    polygon.push_back({0.99 * long_way + 1e-3 * part * part, i + 0.5, 0});
  }
  return polygon;
}

TEST(TriangulatePolygon, FansWhatWouldTakeTheCubeOfItsCorners) {
  const auto polygon = tangled(test::sanitized_or(1000, 4000));  // minutes, to the end
  const std::chrono::nanoseconds before = thread_time();
  std::uint64_t spare_looks = 0;
  const auto triangles = triangulate_polygon(polygon, spare_looks);
  EXPECT_LT(thread_time() - before, std::chrono::seconds(30));
  EXPECT_EQ(triangles.size(), polygon.size() - 2);
}

/// A band of this many corners a side that winds itself up, five corners a turn: an ear is
/// found at its ends alone, and all corners between them are tried.
std::vector<WorldPoint> wound_up(int corners) {
  std::vector<WorldPoint> polygon;
  for (const double inset : {0.0, 0.5}) {
    for (int i = 0; i < corners; ++i) {
      const int at = inset > 0 ? i : corners - 1 - i;
      const double angle = 2 * M_PI * at / 5, radius = 1 + at / 5.0 + inset;
      polygon.push_back({radius * std::cos(angle), radius * std::sin(angle), 0});
    }
  }
  return polygon;
}

TEST(TriangulatePolygon, CutsTheEarsOfBandsThatAreWoundUp) {
  const Areas areas = areas_of(wound_up(750));
  EXPECT_NEAR(areas.wound, areas.all, 1e-9 * areas.all);
}

TEST(TriangulatePolygon, TakesWhatSeveralTakeFromOneStore) {
  const auto polygon = wound_up(750);
  std::uint64_t spare_looks = kSpareLooks;
  const auto cut = triangulate_polygon(polygon, spare_looks);
  const std::uint64_t taken = kSpareLooks - spare_looks;
  ASSERT_GT(taken, 0U);
  spare_looks = taken + taken / 2;
  EXPECT_TRUE(triangulate_polygon(polygon, spare_looks) == cut);
  EXPECT_EQ(spare_looks, taken / 2);
  EXPECT_FALSE(triangulate_polygon(polygon, spare_looks) == cut);
  EXPECT_EQ(spare_looks, 0U);
}

TEST(TriangulatePolygon, CutsTheEarsOfLongCombsToTheEnd) {
  const int teeth = test::sanitized_or(500, 5000);
  std::vector<WorldPoint> comb{{-1, 0, 0}};
  for (int i = 0; i <= teeth; ++i) {
    if (i > 0) comb.push_back({10, i - 0.5, 0});
    comb.push_back({0, 1.0 * i, 0});
  }
  comb.push_back({-1, 1.0 * teeth, 0});
  const Areas areas = areas_of(comb);
  EXPECT_NEAR(areas.wound, 6.0 * teeth, 1e-6);
  EXPECT_NEAR(areas.all, 6.0 * teeth, 1e-6);
}

}  // namespace
}  // namespace tet
