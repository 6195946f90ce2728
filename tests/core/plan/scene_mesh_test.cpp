// What the mesh of a scene promises.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/mesh/boundary.h"
#include "core/plan/make/mesher.h"
#include "core/scene/scene_evaluator.h"
#include "core/stuffing/scene_zeros.h"
#include "tests/core/plan/meshing.h"
#include "tests/support/scenes.h"

namespace tet::scene_mesh_test {
namespace {

using test::expect_sound;
using test::known_scenes;
using test::KnownScene;
using test::same_bytes;
using testing::StartsWith;

/// Positions as they are found, not rounded.
MeshRequest exact(double spacing, int levels = kMaxLevels) {
  MeshRequest request = test::with_levels(levels);
  request.spacing = spacing;
  request.coordinates = CoordinateType::kFloat64;
  return request;
}

absl::StatusOr<MeshResult> try_to_mesh(const Scene& scene,
                                       const MeshRequest& request,
                                       int threads = 2) {
  TaskPool pool(threads);
  return mesh_volume(pool, {.shape = std::make_shared<const Scene>(scene), .request = request});
}

MeshResult mesh(const Scene& scene, const MeshRequest& request, int threads = 2) {
  auto result = try_to_mesh(scene, request, threads);
  EXPECT_TRUE(result.ok()) << result.status();
  return result.ok() ? *std::move(result) : MeshResult{};
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

TEST(SceneMesh, ConformsWithBoundedAnglesOnTheSurfaceWithTheSolidsTopology) {
  for (const KnownScene& known : known_scenes()) {
    SCOPED_TRACE(known.name);
    const MeshResult result = mesh(known.scene, exact(known.spacing));
    expect_sound(result);
    EXPECT_LE(farthest_from_surface(known.scene, result.mesh), kZeroTolerance * known.spacing);
    const BoundaryTopology boundary = measure_boundary(result.mesh);
    EXPECT_EQ(boundary.components, known.components);
    EXPECT_EQ(boundary.euler_characteristic, known.euler_characteristic);
    EXPECT_EQ(boundary.non_manifold_edges, 0U);
    EXPECT_TRUE(result.boundary == boundary);
    if (known.enclosed_volume == 0) continue;
    EXPECT_NEAR(result.quality.volume, known.enclosed_volume, 0.02 * known.enclosed_volume);
  }
}

TEST(SceneMesh, ConvergesToTheSolidsVolume) {
  test::SceneWriter writer;
  writer.add(scene::Torus{1, 0.4});
  const double volume = 2 * M_PI * M_PI * 0.16;
  const auto error = [&](double spacing) {
    return std::abs(mesh(writer.scene(), exact(spacing)).quality.volume / volume - 1);
  };
  EXPECT_LT(error(0.1), 0.01);
  EXPECT_LT(error(0.05), 0.0025);
}

TEST(SceneMesh, HasTheSameBytesForAnyNumberOfThreads) {
  for (const KnownScene& known : known_scenes()) {
    if (known.name != "drilled box" && known.name != "balls in rows") continue;
    const TetMesh one = mesh(known.scene, exact(known.spacing), 1).mesh;
    EXPECT_TRUE(same_bytes(one, mesh(known.scene, exact(known.spacing), 3).mesh)) << known.name;
  }
}

TEST(SceneMesh, HasTheSameBytesHoweverAScenesPartsAreWritten) {
  test::SceneWriter twice, once;
  const std::string ball = twice.add(scene::Sphere{1});
  const std::string at_2 = twice.add_moved({2, 0, 0}, ball);
  const std::string at_5 = twice.add_moved({3, 0, 0}, at_2);
  twice.add(scene::Combination{scene::Combine::kUnion, {ball, at_5}});
  const std::string same = once.add(scene::Sphere{1});
  scene::Repeat repeat{same};
  repeat.count = {2, 1, 1};
  repeat.step = {5, 0, 0};
  once.add(repeat);
  EXPECT_TRUE(
      same_bytes(mesh(twice.scene(), exact(0.2)).mesh, mesh(once.scene(), exact(0.2)).mesh));
}

TEST(SceneMesh, KeepsItsPromisesOnRandomScenes) {
  int meshed = 0;
  for (std::uint32_t seed = 1; seed <= 12; ++seed) {
    const auto scene = make_scene(test::random_scene(seed));
    ASSERT_TRUE(scene.ok()) << scene.status();
    SCOPED_TRACE(seed);
    const auto result = try_to_mesh(*scene, exact(0.13, seed % 3 == 0 ? 0 : kMaxLevels));
    if (!result.ok()) {
      EXPECT_EQ(result.status().code(), absl::StatusCode::kFailedPrecondition);
      continue;
    }
    ++meshed;
    expect_sound(*result);
    EXPECT_LE(farthest_from_surface(*scene, result->mesh), kZeroTolerance * 0.13);
  }
  EXPECT_GT(meshed, 6);
}

TEST(SceneMesh, MeshesBothSidesOfWhatHasNoEndWithinABox) {
  test::SceneWriter writer;
  writer.add(scene::PeriodicSurface{scene::PeriodicKind::kGyroid, 2, 0.3});
  MeshRequest request = exact(0.1);
  EXPECT_EQ(try_to_mesh(writer.scene(), request).status(), check_ends(writer.scene()));
  request.preset = Preset::kBothSides;
  request.box = {{-1, -1, -1}, {1, 1, 1}};
  const MeshResult result = mesh(writer.scene(), request);
  expect_sound(result, Preset::kBothSides);
  const double box = std::pow(3.2, 3);  // rounded outward to 0.8
  EXPECT_NEAR(result.quality.volume, box, 0.03 * box) << "no face is flat where it is cut";
}

TEST(SceneMesh, IsImprovedOnTheSurface) {
  for (const KnownScene& known : known_scenes()) {
    if (known.name != "torus") continue;
    MeshRequest request = exact(known.spacing);
    request.improve = true;
    const MeshResult result = mesh(known.scene, request);
    expect_sound(result);
    EXPECT_GT(result.improvement->moved_vertices, 0U);
    EXPECT_GT(result.quality.min_dihedral_deg, result.improvement->min_dihedral_before_deg + 1);
    EXPECT_LT(farthest_from_surface(known.scene, result.mesh), 1e-3 * known.spacing);
  }
}

std::string refusal(const Scene& scene, const MeshRequest& request) {
  return std::string(try_to_mesh(scene, request).status().message());
}

TEST(SceneMesh, RefusesWhatWouldBeTooMuchBeforeItIsMade) {
  test::SceneWriter writer;
  writer.add(scene::Sphere{1});
  const Scene ball = writer.scene();
  EXPECT_THAT(refusal(ball, exact(1e-4)),
              StartsWith("about 3.5e+07 bricks of 8^3 cells or more lie near the surface"));
  EXPECT_EQ(refusal(ball, exact(1e-12)),
            "the scene reaches 1e+12 spacings from the origin; the limit is 268435456. Use a "
            "larger spacing");
  MeshRequest at_iso = exact(0.1);
  at_iso.iso = 0.5;
  EXPECT_EQ(refusal(ball, at_iso),
            "iso 0.5 is for grids: a scene has its surface at 0, and a node `offset` moves it");
}

TEST(SceneMesh, SaysWhereThereIsNothingInside) {
  test::SceneWriter writer;
  const std::string ball = writer.add(scene::Sphere{1});
  const std::string other = writer.add_moved({3, 0, 0}, ball);
  writer.add(scene::Combination{scene::Combine::kIntersection, {ball, other}});
  EXPECT_EQ(refusal(writer.scene(), exact(0.1)), "nothing of the scene is inside");
  EXPECT_EQ(refusal(writer.scene(), {}),
            "spacing must be given: nothing of the scene is inside");
  test::SceneWriter gone;
  const std::string small = gone.add(scene::Sphere{1});
  gone.add(scene::Combination{scene::Combine::kDifference, {small, small}});
  EXPECT_EQ(refusal(gone.scene(), exact(0.1)),
            "nothing is inside at iso 0, so there is nothing to mesh; a solid thinner than "
            "spacing 0.1 needs a smaller one");
}

}  // namespace
}  // namespace tet::scene_mesh_test
