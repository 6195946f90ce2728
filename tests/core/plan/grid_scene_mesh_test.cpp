// What the mesh of a scene promises whose leaves are grids.
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/mesh/boundary.h"
#include "core/plan/make/mesher.h"
#include "core/scene/scene_evaluator.h"
#include "core/stuffing/scene_zeros.h"
#include "tests/core/plan/meshing.h"
#include "tests/support/grid_scenes.h"
#include "tests/support/scenes.h"

namespace tet::grid_scene_mesh_test {
namespace {

using test::BallGrid;
using test::expect_sound;
using test::fog_of;
using test::grid_of;
using test::leaf;
using test::same_bytes;
using test::SceneWriter;

constexpr double kPi = std::numbers::pi;

MeshRequest exact(double spacing) {
  MeshRequest request;
  request.spacing = spacing;
  request.coordinates = CoordinateType::kFloat64;
  return request;
}

MeshResult mesh(const Scene& scene, const MeshRequest& request, int threads = 2) {
  TaskPool pool(threads);
  auto result =
      mesh_volume(pool, {.shape = std::make_shared<const Scene>(scene), .request = request});
  EXPECT_TRUE(result.ok()) << result.status();
  return result.ok() ? *std::move(result) : MeshResult{};
}

Scene alone(std::shared_ptr<const Volume> volume) {
  SceneWriter writer;
  writer.add(leaf(std::move(volume)));
  return writer.scene();
}

/// A ball from a grid with a hole through it, and a round bar across.
Scene bored_ball(const std::shared_ptr<const Volume>& ball) {
  SceneWriter writer;
  const std::string scan = writer.add(leaf(ball));
  const std::string bore = writer.add(scene::Cylinder{0.4, 3});
  scene::Transform across;
  across.of = writer.add(scene::Capsule{0.15, 1.6});
  across.axis = {1, 0, 0};
  across.angle_deg = 90;
  across.translation = {0, 0.5, 0};
  const std::string bar = writer.add(across);
  const std::string bored =
      writer.add(scene::Combination{scene::Combine::kDifference, {scan, bore}, 0});
  writer.add(scene::Combination{scene::Combine::kUnion, {bored, bar}, 0});
  return writer.scene();
}

/// Largest |phi| over the vertices of the inside's boundary.
double farthest_from_surface(const Scene& scene, const TetMesh& mesh) {
  SceneEvaluator evaluator(scene);
  double farthest = 0;
  for (const Triangle& triangle : boundary_triangles(mesh)) {
    for (const std::uint64_t id : triangle) {
      farthest = std::max(farthest, std::abs(evaluator.at(mesh.vertex(id))));
    }
  }
  return farthest;
}

/// Largest difference between coordinates of meshes with as many vertices.
double farthest_apart(const TetMesh& a, const TetMesh& b) {
  double farthest = 0;
  for (std::uint64_t id = 0; id < a.header.vertex_count; ++id) {
    const WorldPoint p = a.vertex(id), q = b.vertex(id);
    farthest =
        std::max({farthest, std::abs(p.x - q.x), std::abs(p.y - q.y), std::abs(p.z - q.z)});
  }
  return farthest;
}

TEST(GridSceneMesh, OfOneLeafIsTheGridsOwn) {
  // Off the lattice's centres: no two cut points are equally near to a node.
  const BallGrid ball{.centre = {0.013, 0.0271, 0.0411}};
  for (const auto& volume : {grid_of(ball), fog_of(ball)}) {
    const MeshResult of_grid = test::mesh(*volume, exact(0.1));
    const MeshResult of_scene = mesh(alone(volume), exact(0.1));
    ASSERT_EQ(of_scene.mesh.header.vertex_count, of_grid.mesh.header.vertex_count);
    EXPECT_TRUE(std::ranges::equal(of_scene.mesh.tets.bytes(), of_grid.mesh.tets.bytes()));
    // A grid's own cut points are the second step of a secant.
    EXPECT_LT(farthest_apart(of_scene.mesh, of_grid.mesh), 1e-5);
    EXPECT_EQ(of_scene.boundary, of_grid.boundary);
  }
}

TEST(GridSceneMesh, HasTheSolidsTopologyAtAnySpacingHoweverTheGridLies) {
  for (const double spacing : {0.04, 0.13, 0.19}) {
    for (const BallGrid& ball : {BallGrid{}, BallGrid{.turned = true, .shifted = true}}) {
      const Scene scene = alone(grid_of(ball));
      const MeshResult result = mesh(scene, exact(spacing));
      expect_sound(result);
      EXPECT_LE(farthest_from_surface(scene, result.mesh), kZeroTolerance * spacing);
      EXPECT_EQ(result.boundary->components, 1U);
      EXPECT_EQ(result.boundary->euler_characteristic, 2);
      EXPECT_NEAR(result.quality.volume, 4.0 / 3 * kPi, 0.08);
    }
  }
}

TEST(GridSceneMesh, MixesGridsAndPrimitives) {
  for (const BallGrid& ball : {BallGrid{}, BallGrid{.turned = true, .shifted = true}}) {
    const Scene scene = bored_ball(grid_of(ball));
    const MeshResult result = mesh(scene, exact(0.05));
    expect_sound(result);
    EXPECT_LE(farthest_from_surface(scene, result.mesh), kZeroTolerance * 0.05);
    EXPECT_EQ(result.boundary->components, 1U);
    EXPECT_EQ(result.boundary->euler_characteristic, -2) << "a ring with a bar across";
    EXPECT_TRUE(result.boundary == measure_boundary(result.mesh));
  }
}

TEST(GridSceneMesh, MakesWallsAsThickAsAsked) {
  SceneWriter writer;
  writer.add(scene::Shell{writer.add(leaf(grid_of({.band = 4}))), 0.5});
  const MeshResult result = mesh(writer.scene(), exact(0.05));
  expect_sound(result);
  EXPECT_EQ(result.boundary->components, 2U);
  const double wall = 4.0 / 3 * kPi * (std::pow(1.25, 3) - std::pow(0.75, 3));
  EXPECT_NEAR(result.quality.volume, wall, 0.02 * wall);
}

TEST(GridSceneMesh, RepeatsAndStretchesGrids) {
  SceneWriter writer;
  scene::Transform stretch;
  stretch.of = writer.add(leaf(grid_of({})));
  stretch.scale = {1, 1, 2};
  stretch.axis = {1, 2, 0};
  stretch.angle_deg = 30;
  scene::Repeat repeat;
  repeat.of = writer.add(stretch);
  repeat.count = {2, 2, 1};
  repeat.step = {4, 5, 0};
  writer.add(repeat);
  const Scene scene = writer.scene();
  EXPECT_EQ(scene.grids.size(), 1U);
  const MeshResult result = mesh(scene, exact(0.12));
  expect_sound(result);
  EXPECT_EQ(result.boundary->components, 4U);
  EXPECT_NEAR(result.quality.volume, 4 * 8.0 / 3 * kPi, 0.6);
}

TEST(GridSceneMesh, HasTheSameBytesForAnyNumberOfThreads) {
  const Scene scene = bored_ball(grid_of({.turned = true, .shifted = true}));
  EXPECT_TRUE(same_bytes(mesh(scene, exact(0.07), 1).mesh, mesh(scene, exact(0.07), 3).mesh));
}

TEST(GridSceneMesh, KeepsItsPromisesOnGridsOfAnyValues) {
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    SceneWriter writer;
    const std::string noise = writer.add(leaf(test::random_grid(seed)));
    const std::string ball = writer.add(scene::Sphere{0.9});
    writer.add(scene::Combination{static_cast<scene::Combine>(seed % 3), {ball, noise}, 0});
    const Scene scene = writer.scene();
    const MeshResult result = mesh(scene, exact(seed % 2 == 0 ? 0.1 : 0.07));
    expect_sound(result);
    EXPECT_LE(farthest_from_surface(scene, result.mesh), 40 * kZeroTolerance * 0.1)
        << "values change by 20 and more per world unit";
  }
}

TEST(GridSceneMesh, MeshesBothSidesInABox) {
  MeshRequest request = exact(0.1);
  request.preset = Preset::kBothSides;
  request.box = {{-1.6, -1.6, -1.6}, {1.6, 1.6, 1.6}};
  const MeshResult result = mesh(bored_ball(grid_of({})), request);
  expect_sound(result, Preset::kBothSides);
  EXPECT_NEAR(result.quality.volume, std::pow(3.2, 3), 1e-6);
}

}  // namespace
}  // namespace tet::grid_scene_mesh_test
