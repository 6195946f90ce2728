// What a sizing asks of leaves, and what it is refused for.
#include "core/octree/sizing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/octree/sized_cells.h"
#include "tests/core/octree/leaf_map.h"

namespace tet {
namespace {

using test::Everywhere;
using test::LeafMap;

std::string refusal(const Sizing& sizing) {
  const absl::Status status = check_sizing(sizing);
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  return std::string(status.message());
}

TEST(Sizing, IsRefusedWithTheFieldAndItsValue) {
  const BallRegion ball{{}, 1};
  EXPECT_EQ(refusal({.coarsest = 0.0}), "coarsest 0 is not from 1e-15 to 1e+15");
  EXPECT_EQ(refusal({.coarsest = 1.0, .grade_surface = true, .chord_error = 0.0}),
            "chord_error 0 is not from 1e-15 to 1e+15");
  EXPECT_EQ(refusal({.coarsest = 1.0, .grade_surface = true, .leaves_across = 65}),
            "leaves_across 65 is not from 0 to 64");
  EXPECT_EQ(refusal({.leaves_across = 2}),
            "leaves_across is set without grade_surface: leaves at the surface are all finest");
  EXPECT_EQ(refusal({.growth = 2}), "growth 2 is not from 0.0625 to 1");
  EXPECT_EQ(refusal({.growth = std::nan("")}), "growth nan is not from 0.0625 to 1");
  EXPECT_EQ(refusal({.regions = {{1, ball}, {0, ball}}}),
            "regions[1].size 0 is not from 1e-15 to 1e+15");
  EXPECT_EQ(refusal({.regions = {{1, {}}}}),
            "regions[0].shape is not set: set box, ball, capsule or shell");
  EXPECT_EQ(refusal({.regions = {{1, BallRegion{{}, -1}}}}),
            "regions[0].ball.radius -1 is not from 1e-15 to 1e+15");
  EXPECT_EQ(refusal({.regions = {{1, BallRegion{{0, std::nan(""), 0}, 1}}}}),
            "regions[0].ball.centre[1] nan is not from -1e+15 to 1e+15");
  EXPECT_EQ(refusal({.regions = std::vector<SizingRegion>(257, {1, ball})}),
            "regions has 257 entries; the limit is 256");
}

TEST(Sizing, IsRefusedBelowTheSpacing) {
  const auto refused = [](const Sizing& sizing) {
    return std::string(check_sizing(sizing, 0.1).message());
  };
  EXPECT_EQ(refused({.coarsest = 0.05}),
            "coarsest 0.05 is below the spacing 0.1, the size of the smallest leaves: use a "
            "larger one");
  EXPECT_EQ(refused({.regions = {{0.09, ShellRegion{1}}}}),
            "regions[0].size 0.09 is below the spacing 0.1, the size of the smallest leaves: "
            "use a larger one");
  EXPECT_EQ(refused({.coarsest = 0.1, .regions = {{0.1, ShellRegion{1}}}}), "");
}

TEST(Sizing, TakesTheLargestLeavesThatAreNotTooLarge) {
  EXPECT_EQ(level_of_size(0.1, 0.1, 9), 0);
  EXPECT_EQ(level_of_size(0.19, 0.1, 9), 0);
  EXPECT_EQ(level_of_size(0.8, 0.1, 9), 3) << "within rounding errors";
  EXPECT_EQ(level_of_size(0.79, 0.1, 9), 2);
  EXPECT_EQ(level_of_size(1e15, 1e-15, 9), 9);
}

/// The leaves of the map's cube around one finest cell.
LeafMap grow(const Sizing& sizing, int levels = 24) {
  const Everywhere all(48);
  const OctreeCover cover{{{{-8, -8, -8}, {7, 7, 7}}}, {}};
  const auto rules = leaf_rules(sizing, all.field, cover, levels, 1e6, {});
  EXPECT_TRUE(rules.ok()) << rules.status();
  return test::leaves_of(
      build_octree(test::one_cell({0, 0, 0}, 0, 0, 0), all.field, all.inside, cover, *rules));
}

/// Calls `visit(middle, size)` for each leaf.
template <class Visit>
void for_each_leaf(const LeafMap& leaves, const Visit& visit) {
  leaves.for_each_cell([&](int x, int y, int z, int level) {
    const int edge = 1 << level;
    if (((x | y | z) & (edge - 1)) != 0) return;
    visit(WorldPoint{x + edge / 2.0, y + edge / 2.0, z + edge / 2.0}, edge);
  });
}

double distance(const WorldPoint& a, const WorldPoint& b) {
  return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z);
}

TEST(Sizing, LetsLeavesGrowNoFasterThanAsked) {
  for (const double growth : {1.0, 0.5, 0.3, 0.125}) {
    SCOPED_TRACE(growth);
    const LeafMap leaves = grow({.growth = growth});
    test::expect_balanced(leaves);
    int largest = 0;
    for_each_leaf(leaves, [&](const WorldPoint& middle, int size) {
      // The finest cells are those at the origin.
      EXPECT_LE(size, 1 + growth * distance(middle, {1, 1, 1}) + 1e-9);
      largest = std::max(largest, size);
    });
    EXPECT_GE(largest, growth > 0.2 ? 8 : 4) << "and not much slower";
  }
}

TEST(Sizing, KeepsLeavesOfARegionSmall) {
  const WorldPoint centre{-20, 10, 5};
  for (const int size : {1, 2, 4}) {
    SCOPED_TRACE(size);
    const LeafMap leaves = grow({.regions = {{size * 1.5, BallRegion{centre, 9}}}});
    test::expect_balanced(leaves);
    int within = 0;
    for_each_leaf(leaves, [&](const WorldPoint& middle, int edge) {
      if (distance(middle, centre) > 9) return;
      EXPECT_LE(edge, size);
      ++within;
    });
    const double volume = 4.0 / 3 * M_PI * 9 * 9 * 9;
    EXPECT_NEAR(within * std::pow(size, 3), volume, 0.1 * volume) << "all of that size";
  }
}

TEST(Sizing, KnowsRegionsOfEveryShape) {
  const WorldBox box{{-30, -30, -30}, {-22, -14, 30}};
  const CapsuleRegion capsule{{-20, -20, -20}, {20, 20, 20}, 3};
  const LeafMap leaves = grow({.regions = {{2, box}, {1, capsule}, {4, ShellRegion{20}}}});
  test::expect_balanced(leaves);
  for_each_leaf(leaves, [&](const WorldPoint& p, int edge) {
    const bool in_box = p.x > -30 && p.x < -22 && p.y > -30 && p.y < -14 && std::abs(p.z) < 30;
    const double along = std::clamp((p.x + p.y + p.z) / 3, -20.0, 20.0);
    const bool in_capsule = distance(p, {along, along, along}) < 3;
    EXPECT_LE(edge, in_capsule ? 1 : in_box ? 2 : distance(p, {1, 1, 1}) < 20 ? 4 : 64);
  });
}

// Thinner than what rounding errors are allowed, and just where two cells meet.
TEST(Sizing, KeepsLeavesSmallInARegionAsThinAsASheet) {
  for (const double half : {1e-3, 1e-7, 1e-10}) {
    const WorldBox sheet{{-16 - half, -24, -24}, {-16 + half, -8, -8}};
    const LeafMap leaves = grow({.regions = {{1, sheet}}});
    for (const int x : {-17, -16}) {
      EXPECT_EQ(leaves.at(x, -16, -16), 0) << x << ", " << half << " thick on either side";
    }
  }
}

/// A grid of sizes with voxels of `voxel`, which ask for `size` from (-16, -16, -16) to 16 and
/// for nothing elsewhere.
Sizing by_grid(float size, double voxel) {
  VoxelTransform transform;
  transform.voxel_size = voxel;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    transform.linear[axis][axis] = voxel;
    transform.translation[axis] = voxel / 2;  // voxels begin where leaves do
  }
  VolumeBuilder builder(VolumeKind::kLevelSet, 0, transform);
  const auto half = static_cast<std::int32_t>(std::lround(16 / voxel / kBrickEdge));
  for_each_brick({{-half, -half, -half}, {half - 1, half - 1, half - 1}},
                 [&](BrickCoord brick) {
                   std::array<float, kBrickCells> values;
                   values.fill(size);
                   values[0] = size / 2;  // of each brick the first voxel asks for less
                   if (brick.z < 0) {
                     builder.add_constant_brick(brick, size);
                   } else {
                     builder.add_brick(brick, values);
                   }
                 });
  Sizing sizing;
  sizing.grid = SizingGrid{"", "", std::make_shared<const Volume>(*std::move(builder).build())};
  return sizing;
}

TEST(Sizing, KeepsLeavesAsSmallAsAGridSays) {
  for (const double voxel : {0.5, 1.0, 2.0}) {
    SCOPED_TRACE(voxel);
    const LeafMap leaves = grow(by_grid(2, voxel));
    test::expect_balanced(leaves);
    for_each_leaf(leaves, [&](const WorldPoint& p, int edge) {
      const double most = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
      EXPECT_LE(edge, most < 16 ? 2 : 64);
    });
    const int brick = static_cast<int>(8 * voxel);
    EXPECT_EQ(leaves.at(-brick, 0, 0), 0) << "where a brick's first voxel lies";
  }
  EXPECT_EQ(grow(by_grid(4, 1)).at(-13, -13, -13), 2) << "and not smaller";
}

TEST(Sizing, KeepsLeavesSmallAtAVoxelAsSmallAsAPoint) {
  for (const double voxel : {1e-2, 1e-7}) {
    VoxelTransform transform;
    transform.voxel_size = voxel;
    for (std::size_t axis = 0; axis < 3; ++axis) transform.linear[axis][axis] = voxel;
    transform.translation = {-16, -15.5, -15.5};  // where two cells meet
    VolumeBuilder builder(VolumeKind::kLevelSet, 0, transform);
    std::array<float, kBrickCells> values{};
    values[0] = 1;
    builder.add_brick({0, 0, 0}, values);
    Sizing sizing;
    sizing.grid =
        SizingGrid{"", "", std::make_shared<const Volume>(*std::move(builder).build())};
    const LeafMap leaves = grow(sizing);
    for (const int x : {-17, -16}) EXPECT_EQ(leaves.at(x, -16, -16), 0) << x << ' ' << voxel;
  }
}

TEST(Sizing, TakesAGridsPositiveBackgroundForTheCoarsestSize) {
  Sizing sizing;
  VolumeBuilder builder(VolumeKind::kLevelSet, 0.4F);
  sizing.grid = SizingGrid{"", "", std::make_shared<const Volume>(*std::move(builder).build())};
  EXPECT_EQ(levels_of(sizing, 0.1, 24), 2);
}

TEST(Sizing, KeepsAllLeavesAtMostAsCoarseAsAsked) {
  EXPECT_EQ(levels_of({.coarsest = 0.5}, 0.1, 24), 2);
  EXPECT_EQ(levels_of({.coarsest = 0.5}, 0.1, 1), 1);
  EXPECT_EQ(levels_of({}, 0.1, 24), 24);
}

TEST(Sizing, RefusesMoreLeavesThanThereMayBe) {
  const Everywhere all(1 << 28);
  const OctreeCover cover{
      {{{-(1 << 25), -(1 << 25), -(1 << 25)}, {(1 << 25) - 1, (1 << 25) - 1, (1 << 25) - 1}}},
      {}};
  const auto leaves = [&](double radius) {
    return leaf_rules({.regions = {{4, ShellRegion{1}}, {1, BallRegion{{}, radius}}}},
                      all.field, cover, 24, 1e7, {})
        .status();
  };
  EXPECT_TRUE(leaves(100).ok());
  EXPECT_EQ(leaves(1e7).message(),
            "sizing.regions[1].size 1 asks for more than 1e+07 leaves, the most there may be: "
            "use a larger size or a smaller region");
}

}  // namespace
}  // namespace tet
