// Meshes whose leaves are as small as a sizing asks.
#include <cmath>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "core/plan/brick/brick_plan.h"
#include "tests/core/plan/meshing.h"
#include "tests/support/scenes.h"
#include "tests/support/solids.h"

namespace tet::sized_mesh_test {
namespace {

using test::expect_sound;
using test::mesh;
using test::same_bytes;

constexpr double kRadius = 30;

MeshRequest sized(const Sizing& sizing) {
  MeshRequest request;
  request.sizing = sizing;
  return request;
}

absl::StatusOr<std::shared_ptr<const MeshPlan>> try_to_plan(const Shape& shape,
                                                            const MeshRequest& request) {
  return plan_mesh({.shape = shape, .request = request});
}

/// A ball around the origin, of a grid with voxels of 1, as a scene: exact distances.
Shape ball_scene() {
  test::SceneWriter writer;
  writer.add(scene::Sphere{kRadius});
  return std::make_shared<const Scene>(writer.scene());
}

/// Calls `visit(middle, size)` for each leaf above the finest level: in finest spacings.
template <class Visit>
void for_each_coarse_leaf(const MeshPlan& plan, const Visit& visit) {
  const Octree& tree = as_bricks(plan)->counted().mesh.tree();
  for (std::size_t l = 1; l < tree.levels.size(); ++l) {
    const double size = std::ldexp(1, static_cast<int>(l));
    for (std::size_t i = 0; i < tree.levels[l].bricks.size(); ++i) {
      const BrickCoord b = tree.levels[l].bricks[i];
      for_each_bit(tree.levels[l].leaf[i], [&](int x, int y, int z) {
        const auto middle = [&](std::int32_t brick, int cell) {
          return size * (8.0 * brick + cell + 0.5);
        };
        visit(WorldPoint{middle(b.x, x), middle(b.y, y), middle(b.z, z)}, size);
      });
    }
  }
}

TEST(SizedMesh, GrowsNoFasterThanAskedFromTheSurface) {
  for (const double growth : {1.0, 0.5, 0.2}) {
    SCOPED_TRACE(growth);
    MeshRequest request = sized({.growth = growth});
    request.spacing = 1;
    const auto plan = try_to_plan(ball_scene(), request);
    ASSERT_TRUE(plan.ok()) << plan.status();
    double largest = 0;
    for_each_coarse_leaf(**plan, [&](const WorldPoint& middle, double size) {
      const double depth = kRadius - std::hypot(middle.x, middle.y, middle.z);
      EXPECT_LE(size, 1 + growth * depth);
      largest = std::max(largest, size);
    });
    EXPECT_GE(largest, growth < 0.5 ? 2 : 4);
  }
}

TEST(SizedMesh, KeepsLeavesWithinAShellSmall) {
  MeshRequest request = sized({.regions = {{1, ShellRegion{6.5}}}});
  request.spacing = 1;
  const auto plan = try_to_plan(ball_scene(), request);
  ASSERT_TRUE(plan.ok()) << plan.status();
  std::size_t leaves = 0;
  for_each_coarse_leaf(**plan, [&](const WorldPoint& middle, double size) {
    const double depth = kRadius - std::hypot(middle.x, middle.y, middle.z);
    EXPECT_GE(depth + std::sqrt(3.0) / 2 * size, 6.5);
    ++leaves;
  });
  EXPECT_GT(leaves, 0U);
}

TEST(SizedMesh, KnowsShellsThatReachThroughAll) {
  MeshRequest request = sized({.regions = {{2, ShellRegion{1e15}}}});
  request.spacing = 1;
  const auto plan = try_to_plan(ball_scene(), request);
  ASSERT_TRUE(plan.ok()) << plan.status();
  for_each_coarse_leaf(**plan, [](const WorldPoint&, double size) { EXPECT_EQ(size, 2); });
}

const Sizing kSizing{
    .coarsest = 4.0,
    .growth = 0.5,
    .regions = {{1, BallRegion{{3, 1, -2}, 6}}, {2, WorldBox{{-20, -4, 0}, {0, 4, 9}}}}};

TEST(SizedMesh, ConformsWithTheSameSurfaceAndTheSameBytes) {
  const Volume ball = test::ball(19.3);
  const MeshResult plain = mesh(ball);
  for (const Preset preset : {Preset::kDefault, Preset::kBothSides}) {
    MeshRequest request = sized(kSizing);
    request.preset = preset;
    const MeshResult result = mesh(ball, request);
    EXPECT_GT(result.mesh.header.tet_count, plain.mesh.header.tet_count);
    expect_sound(result, preset);
    EXPECT_TRUE(same_bytes(result.mesh, mesh(ball, request, 1).mesh));
    if (preset != Preset::kDefault) continue;
    EXPECT_TRUE(result.boundary == plain.boundary);
    EXPECT_NEAR(result.quality.volume, plain.quality.volume, 1e-9 * plain.quality.volume);
  }
}

TEST(SizedMesh, IsRefusedWithTheFieldThatIsFinerThanTheVoxels) {
  const auto refusal = [](const Sizing& sizing) {
    const auto volume = std::make_shared<const Volume>(test::ball(5));
    return std::string(try_to_plan(volume, sized(sizing)).status().message());
  };
  EXPECT_EQ(refusal({.coarsest = 0.5}),
            "sizing.coarsest 0.5 is below the spacing 1, the size of the smallest leaves: use "
            "a larger one");
  EXPECT_EQ(refusal({.regions = {{0.5, ShellRegion{1}}}}),
            "sizing.regions[0].size 0.5 is below the spacing 1, the size of the smallest "
            "leaves: use a larger one");
}

TEST(SizedMesh, IsRefusedWhereItWouldBeTooLarge) {
  MeshRequest request =
      sized({.regions = {{1e-5, ShellRegion{1e-4}}, {1e-5, BallRegion{{}, 1}}}});
  request.preset = Preset::kBothSides;
  request.spacing = 1e-5;
  request.box = {{-1, -1, -1}, {1, 1, 1}};
  test::SceneWriter writer;
  writer.add(scene::Sphere{2e-4});
  const auto plan = try_to_plan(std::make_shared<const Scene>(writer.scene()), request);
  EXPECT_EQ(
      plan.status().message(),
      "sizing.regions[1].size 1e-05 asks for more than 2.67e+09 leaves, the most there may be: "
      "use a larger size or a smaller region");
}

}  // namespace
}  // namespace tet::sized_mesh_test
