// What a mesh says where the lattice is too coarse for the surface's walls.
#include "core/plan/thin_walls.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/mesh/boundary.h"
#include "core/plan/make/mesher.h"
#include "core/stuffing/thin_walls.h"
#include "tests/support/solids.h"
#include "tests/support/volume_fixtures.h"

namespace tet::thin_walls_test {
namespace {

using test::Plate;
using ::testing::HasSubstr;

struct Meshed {
  absl::Status status;
  ThinWalls walls;
  BoundaryTopology boundary;

  bool is_a_ball() const {
    return status.ok() && boundary.components == 1 && boundary.euler_characteristic == 2 &&
           boundary.non_manifold_edges == 0 && boundary.non_manifold_vertices == 0;
  }
};

Meshed mesh(Volume volume, std::optional<double> spacing = std::nullopt, int threads = 2) {
  MeshRequest request;
  request.spacing = spacing;
  TaskPool pool(threads);
  const auto result = mesh_volume(
      pool, {.shape = std::make_shared<const Volume>(std::move(volume)), .request = request});
  if (!result.ok()) return {result.status(), {}, {}};
  return {absl::OkStatus(), result->thin_walls, measure_boundary(result->mesh)};
}

constexpr std::array<WorldPoint, 6> kNormals{
    {{0, 0, 1}, {0, 1, 1}, {1, 1, 1}, {0.36, 0.48, 0.8}, {-0.2, 0.9, 0.1}, {0.5, -0.6, 0.1}}};

bool has_inside_voxels(const Volume& volume) {
  return std::ranges::any_of(volume.values, [](float phi) { return phi < 0; });
}

TEST(ThinWalls, NeverLetAPlateOfAnotherTopologyPassUnsaid) {
  for (const double thickness : {0.5, 0.8, 1.0, 1.2, 1.5, 3.0}) {
    for (const WorldPoint& normal : kNormals) {
      const Volume plate = test::plate({.thickness = thickness, .normal = normal});
      const Meshed made = mesh(plate);
      if (made.is_a_ball()) continue;
      SCOPED_TRACE(thickness);
      if (made.status.ok()) {
        EXPECT_GT(made.walls.inside, 0U);
      } else {
        EXPECT_THAT(std::string(made.status.message()),
                    HasSubstr(has_inside_voxels(plate) ? "thinner than spacing 1 resolves"
                                                       : "nothing is inside at iso 0"));
      }
    }
  }
}

/// Along no lattice line, plane or diagonal.
constexpr std::array kTilted{kNormals[3], kNormals[4], kNormals[5]};

TEST(ThinWalls, TellOfPlatesOfHalfAVoxelAndOfOneAndNotOfThree) {
  for (const WorldPoint& normal : kTilted) {
    const Meshed half = mesh(test::plate({.thickness = 0.5, .normal = normal}));
    EXPECT_FALSE(half.is_a_ball());
    const Meshed one = mesh(test::plate({.thickness = 1.0, .normal = normal}));
    EXPECT_FALSE(one.is_a_ball());
    EXPECT_GT(one.walls.inside, 300U) << "all over the plate";
    const Meshed thick = mesh(test::plate({.thickness = 1.5, .normal = normal}));
    EXPECT_TRUE(thick.is_a_ball());
    EXPECT_LT(thick.walls.inside, 60U) << "at the rim only, which is rounded";
    const Meshed three = mesh(test::plate({.thickness = 3.0, .normal = normal}));
    EXPECT_TRUE(three.is_a_ball());
    EXPECT_FALSE(three.walls.any());
  }
}

TEST(ThinWalls, SuggestASpacingThatResolvesThem) {
  for (const double thickness : {0.8, 1.0, 1.5}) {
    for (const WorldPoint& normal : kTilted) {
      SCOPED_TRACE(thickness);
      const Meshed coarse = mesh(test::plate({.thickness = thickness, .normal = normal}));
      ASSERT_TRUE(coarse.walls.any());
      const double finer = coarse.walls.suggested_spacing;
      if (thickness >
          static_cast<double>(
              kResolvedChord)) {  // the rim alone is thin: no wall tells how thick it is
        EXPECT_EQ(finer, 0);
        continue;
      }
      EXPECT_GT(finer, thickness / 10) << "no finer than it has to be";
      // A plate of the same thickness, but of another width, is sampled anew with voxels of
      // that size.
      const Meshed fine = mesh(
          test::plate({.thickness = thickness / finer, .radius = 4 / finer, .normal = normal},
                      test::scaled(finer)));
      EXPECT_TRUE(fine.is_a_ball());
      EXPECT_FALSE(fine.walls.any());
    }
  }
}

/// A wedge of `degrees`, `edge` voxels long on each side, turned.
Volume wedge(double degrees, double edge) {
  const double half = degrees * M_PI / 360, c = std::cos(0.7), s = std::sin(0.7);
  const auto reach = static_cast<std::int32_t>(edge) + 6;
  return test::narrow_band_volume(
      {{-reach, -reach, -reach}, {reach, reach, reach}}, 3, [&](const VoxelCoord& v) {
        const double x = c * v.x - s * v.y + edge / 2, u = s * v.x + c * v.y;
        const double y = c * u - s * v.z, z = s * u + c * v.z;
        const double sides = std::abs(y) * std::cos(half) - x * std::sin(half);
        const double phi = std::max({sides, x - edge, std::abs(z) - edge / 2});
        return static_cast<float>(std::clamp(phi, -3.0, 3.0));
      });
}

TEST(ThinWalls, SuggestNoSpacingWhereAWallComesDownToNothing) {
  for (const double degrees : {20.0, 40.0, 60.0}) {
    for (const double edge : {24.0, 48.0}) {
      SCOPED_TRACE(degrees);
      const Meshed made = mesh(wedge(degrees, edge));
      ASSERT_TRUE(made.status.ok()) << made.status;
      EXPECT_TRUE(made.walls.any()) << edge;
      EXPECT_EQ(made.walls.suggested_spacing, 0) << edge;
      EXPECT_GT(made.walls.thickness, 0);
    }
  }
}

TEST(ThinWalls, TellGapsFromWalls) {
  const Meshed narrow = mesh(test::ball_with_gap(24, 0.8));
  ASSERT_TRUE(narrow.status.ok());
  EXPECT_GT(narrow.walls.outside, 100U);
  EXPECT_EQ(narrow.walls.inside, 0U);
  EXPECT_NE(narrow.boundary.components, 3U);
  const Meshed wide = mesh(test::ball_with_gap(24, 3));
  EXPECT_FALSE(wide.walls.any());
  EXPECT_EQ(wide.boundary.components, 3U) << "the gap's two sides and the ball's";
}

TEST(ThinWalls, AreNotSeenInThickSolids) {
  for (const double spacing : {1.0, 1.7, 3.0}) {
    SCOPED_TRACE(spacing);
    EXPECT_FALSE(mesh(test::ball(16), spacing).walls.any());
    EXPECT_FALSE(mesh(test::tilted_cube(24), spacing).walls.any())
        << "edges of 90 degrees are no walls";
  }
  EXPECT_FALSE(mesh(test::fog_ball(12)).walls.any());
}

TEST(ThinWalls, AreSeenBetweenTheNodesOfACoarseLattice) {
  // A plate of one and a half voxels: most of it lies between nodes four voxels apart.
  const Plate thin{.thickness = 1.5, .radius = 30, .normal = kNormals[4]};
  const Meshed missed = mesh(test::plate(thin), 4);
  ASSERT_FALSE(missed.is_a_ball());
  if (missed.status.ok()) {
    EXPECT_GT(missed.walls.inside, 100U);
  } else {
    EXPECT_THAT(std::string(missed.status.message()), HasSubstr("thinner than spacing 4"));
  }
  // Flat and level with the voxels, it passes every node by: x = 2 (mod 4) has none.
  const auto fin = [](VoxelCoord v) {
    const double ball = std::hypot(v.x + 30, v.y, v.z) - 20;
    const double plate =
        std::max({std::abs(v.x - 10) - 0.75, std::abs(v.y) - 20.0, std::abs(v.z) - 20.0});
    return static_cast<float>(std::min(ball, plate));
  };
  const Meshed without =
      mesh(test::narrow_band_volume({{-60, -30, -30}, {30, 30, 30}}, 3, fin), 4);
  ASSERT_TRUE(without.status.ok());
  EXPECT_EQ(without.boundary.components, 1U) << "the plate is not meshed at all";
  EXPECT_GT(without.walls.inside, 50U);
  EXPECT_NEAR(without.walls.thickness, 1.5, 0.5);
  ASSERT_EQ(without.walls.region_count, 1U);
  EXPECT_GT(without.walls.regions[0].box.max.x, 10);
  EXPECT_LT(without.walls.regions[0].box.min.x, 10);
  EXPECT_GT(without.walls.regions[0].box.min.x, 0) << "not at the ball";
}

/// Plates of one voxel in a row, 40 voxels apart.
Volume many_plates(int count) {
  return test::narrow_band_volume(
      {{-10, -10, -10}, {40 * count + 10, 10, 10}}, 3, [](VoxelCoord v) {
        const double x = std::fmod(v.x + 20.0, 40.0) - 20;
        const double along = std::max(0.0, std::hypot(x, v.y) - 6);
        return static_cast<float>(std::hypot(along, v.z - 0.2) - 0.5);
      });
}

TEST(ThinWalls, ListTheRegionsWithTheMostSpotsInBoxesAroundThem) {
  const Meshed three = mesh(many_plates(2));
  ASSERT_TRUE(three.status.ok()) << three.status;
  ASSERT_EQ(three.walls.region_count, 3U);
  std::uint64_t listed = 0;
  for (const ThinWalls::Region& region : three.walls.regions) {
    listed += region.inside;
    const double middle = (region.box.min.x + region.box.max.x) / 2;
    EXPECT_LT(std::abs(middle - 40 * std::round(middle / 40)), 2) << "around one plate";
    EXPECT_LT(region.box.max.x - region.box.min.x, 16);
    EXPECT_LT(region.box.min.z, 0.2);
    EXPECT_GT(region.box.max.z, 0.2);
  }
  EXPECT_EQ(listed, three.walls.inside);
  const Meshed many = mesh(many_plates(19));
  EXPECT_EQ(many.walls.region_count, 20U);
  EXPECT_EQ(many.walls.regions.size(), ThinWalls::kMaxRegions);
}

TEST(ThinWalls, AreTheSameForAnyNumberOfThreads) {
  const auto same = [](const ThinWalls& a, const ThinWalls& b) {
    bool equal = a.inside == b.inside && a.outside == b.outside &&
                 a.region_count == b.region_count && a.thickness == b.thickness &&
                 a.regions.size() == b.regions.size();
    for (std::size_t i = 0; equal && i < a.regions.size(); ++i) {
      equal = a.regions[i].box.min == b.regions[i].box.min &&
              a.regions[i].box.max == b.regions[i].box.max &&
              a.regions[i].inside == b.regions[i].inside;
    }
    return equal;
  };
  for (const std::optional<double> spacing : {std::optional<double>(), std::optional(2.3)}) {
    const Meshed one = mesh(test::random_signs(24, 9), spacing, 1);
    ASSERT_TRUE(one.walls.any());
    EXPECT_GT(one.walls.outside, 0U);
    for (const int threads : {2, 16}) {
      EXPECT_TRUE(same(mesh(test::random_signs(24, 9), spacing, threads).walls, one.walls));
    }
  }
}

}  // namespace
}  // namespace tet::thin_walls_test
