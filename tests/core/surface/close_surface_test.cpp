#include "core/surface/close_surface.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/surface/winding_tree.h"
#include "tests/support/random_surfaces.h"
#include "tests/support/surfaces.h"

namespace tet {
namespace {

using test::box_surface;
using test::inside_out;
using test::joined;

constexpr double kTolerance = 1e-3, kGap = 0.5;

ClosedSurface closed(const TriangleSurface& surface) {
  return close_surface(surface, kTolerance, kGap);
}

TEST(CloseSurface, LeavesAClosedSurfaceAsItIs) {
  const auto box = box_surface({0, 0, 0}, {2, 3, 4});
  const ClosedSurface result = closed(box);
  EXPECT_EQ(result.surface.triangles, box.triangles);
  EXPECT_EQ(result.holes, 0U);
  EXPECT_EQ(result.turned_bodies, 0U);
  EXPECT_DOUBLE_EQ(result.volume, 24);
  EXPECT_DOUBLE_EQ(result.area, 52);
}

TEST(CloseSurface, CapsAHoleOfAnyNumberOfEdges) {
  for (std::size_t missing = 1; missing <= 11; ++missing) {
    const ClosedSurface result =
        closed(test::without(box_surface({0, 0, 0}, {9, 9, 9}), 0, missing));
    EXPECT_GT(result.holes, 0U);
    for (const auto& p :
         {WorldPoint{4.1, 5.23, 3.37}, WorldPoint{1.03, 2.57, 8.19}, WorldPoint{20, 1, 1}}) {
      const double w = exact_winding_number(result.surface, p);
      EXPECT_NEAR(w, std::round(w), 1e-9) << missing << " triangles missing";
    }
  }
  const ClosedSurface one = closed(test::without(box_surface({0, 0, 0}, {9, 9, 9}), 3, 1));
  EXPECT_NEAR(one.volume, 729, 1e-9);
  EXPECT_EQ(one.open_edges, 3U);
  EXPECT_FALSE(one.nearly_closed(1));
}

TEST(CloseSurface, MakesWholeWindingNumbersOfAnything) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const test::RandomSurface made = test::random_surface(seed);
    const ClosedSurface result =
        close_surface(made.surface, kTolerance * made.voxel_size, kGap * made.voxel_size);
    const WorldPoint& a = made.surface.vertices[0];
    const WorldPoint& b = made.surface.vertices[made.surface.vertices.size() / 2];
    for (const double t : {-0.21, 0.13, 0.37, 0.52, 0.83, 1.17}) {
      const WorldPoint p{a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), a.z + t * (b.z - a.z)};
      // Halves and quarters on faces and edges.
      const double w = 24 * exact_winding_number(result.surface, p);
      EXPECT_NEAR(w / 24, std::round(w) / 24, 0.02) << made.what << ", seed " << seed;
    }
  }
}

TEST(CloseSurface, WindsTrianglesAlikeTheWayThatMostAre) {
  auto sphere = test::sphere_surface({}, 5, 16);
  const double volume = test::volume_of(sphere);
  for (const std::size_t i : {3U, 50U, 51U, 200U}) {
    std::swap(sphere.triangles[i][0], sphere.triangles[i][1]);
  }
  const ClosedSurface result = closed(sphere);
  EXPECT_EQ(result.turned_triangles, 4U);
  EXPECT_NEAR(result.volume, volume, 1e-9);
  EXPECT_EQ(closed(inside_out(sphere)).turned_bodies, 1U);
  EXPECT_NEAR(closed(inside_out(sphere)).volume, volume, 1e-9);
}

TEST(CloseSurface, KeepsCavitiesAndTurnsBodiesRound) {
  const auto outer = box_surface({0, 0, 0}, {9, 9, 9}),
             inner = box_surface({3, 3, 3}, {6, 6, 6});
  const auto beside = box_surface({10, 0, 0}, {12, 2, 2});
  EXPECT_NEAR(closed(joined(outer, inside_out(inner))).volume, 729 - 27, 1e-9);
  EXPECT_NEAR(closed(inside_out(joined(outer, inside_out(inner)))).volume, 729 - 27, 1e-9);
  const ClosedSurface mixed = closed(joined(outer, inside_out(beside)));
  EXPECT_NEAR(mixed.volume, 729 + 8, 1e-9);
  EXPECT_EQ(mixed.turned_bodies, 1U);
  // A solid within the cavity is one, and one that is wound inwards there is turned round.
  const auto core = box_surface({4, 4, 4}, {5, 5, 5});
  for (const auto& wound : {core, inside_out(core)}) {
    EXPECT_NEAR(closed(joined(joined(outer, inside_out(inner)), wound)).volume, 729 - 27 + 1,
                1e-9);
  }
}

TEST(CloseSurface, LeavesDoubledTrianglesOut) {
  const auto box = box_surface({0, 0, 0}, {2, 2, 2});
  EXPECT_NEAR(closed(joined(box, box)).volume, 8, 1e-9);
  EXPECT_EQ(closed(joined(box, box)).doubled_triangles, 12U);
  // Once for each side of them.
  EXPECT_NEAR(closed(joined(box, inside_out(box))).volume, 8, 1e-9);
  const auto open = test::without(box, 0, 4);
  EXPECT_FALSE(closed(joined(open, inside_out(open))).nearly_closed(0.1));
  // The wall between two boxes is none.
  const auto beside = box_surface({2, 0, 0}, {4, 2, 2});
  const ClosedSurface both = closed(joined(box, beside));
  EXPECT_NEAR(both.volume, 16, 1e-9);
  EXPECT_TRUE(both.holes == 0);
}

TEST(CloseSurface, WeldsWhatIsNearlyAtOnePlace) {
  auto torn = test::torn(box_surface({0, 0, 0}, {9, 9, 9}));
  for (std::size_t i = 0; i < torn.vertices.size(); ++i) {
    torn.vertices[i].x += 1e-7 * static_cast<double>(i % 5);
  }
  const ClosedSurface result = closed(torn);
  EXPECT_EQ(result.holes, 0U);
  EXPECT_NEAR(result.volume, 729, 1e-3);
  // Faces that end a quarter of a voxel before they meet.
  auto apart = test::torn(box_surface({0, 0, 0}, {9, 9, 9}));
  for (std::size_t i = 0; i < apart.vertices.size(); i += 3) {
    for (std::size_t c = 0; c < 3; ++c) apart.vertices[i + c].z += i % 2 == 0 ? 0.12 : -0.12;
  }
  EXPECT_TRUE(closed(apart).nearly_closed(0));
  EXPECT_NEAR(closed(apart).volume, 729, 20);
}

TEST(CloseSurface, ClosesTJunctions) {
  auto box = box_surface({0, 0, 0}, {2, 2, 2});
  // One triangle becomes two, by a vertex in the middle of a side that its neighbour has whole.
  const auto [a, b, c] = box.triangles[0];
  const auto middle = static_cast<std::uint32_t>(box.vertices.size());
  box.vertices.push_back({(box.vertices[a].x + box.vertices[b].x) / 2,
                          (box.vertices[a].y + box.vertices[b].y) / 2,
                          (box.vertices[a].z + box.vertices[b].z) / 2});
  box.triangles[0] = {a, middle, c};
  box.triangles.push_back({middle, b, c});
  const ClosedSurface result = closed(box);
  EXPECT_EQ(result.open_edges, 3U);
  EXPECT_TRUE(result.nearly_closed(0));
  EXPECT_NEAR(result.volume, 8, 1e-9);
}

TEST(CloseSurface, FindsNothingInASheet) {
  TriangleSurface sheet;
  sheet.vertices = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}};
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
  const ClosedSurface result = closed(sheet);
  EXPECT_FALSE(result.nearly_closed(1));
  EXPECT_NEAR(result.volume, 0, 1e-12);
  EXPECT_NEAR(result.cap_area, 16, 1e-9);
}

TEST(CloseSurface, TellsAnOpenSurfaceFromAClosedOne) {
  // A tetrahedron whose faces share no vertices, as STL would have it.
  TriangleSurface tetrahedron;
  tetrahedron.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  tetrahedron.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  TriangleSurface surface = test::torn(tetrahedron);
  EXPECT_EQ(closed(surface).open_edges, 0U);
  surface.triangles.push_back({0, 0, 1});  // a line hurts nobody
  EXPECT_EQ(closed(surface).open_edges, 0U);
  const auto away = static_cast<std::uint32_t>(surface.vertices.size());
  surface.vertices.push_back({5, 5, 5});
  surface.triangles.push_back({0, 1, away});  // another side on one of its edges
  EXPECT_EQ(closed(surface).non_manifold_edges, 1U);
  surface.triangles.pop_back();
  surface.triangles.erase(surface.triangles.begin());
  EXPECT_EQ(closed(surface).open_edges, 3U);
}

}  // namespace
}  // namespace tet
