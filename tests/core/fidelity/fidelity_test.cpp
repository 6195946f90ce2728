// The report on a mesh's surface, held against solids whose answers are known.
#include "core/fidelity/fidelity.h"

#include <atomic>
#include <chrono>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include <gtest/gtest.h>

#include "core/base/parallel.h"
#include "core/fidelity/surface_triangles.h"
#include "core/plan/make/mesher.h"
#include "tests/support/scenes.h"
#include "tests/support/solids.h"

namespace tet {
namespace {

constexpr double kPi = std::numbers::pi;

Shape ball_scene(double radius) {
  test::SceneWriter writer;
  writer.add(scene::Sphere{radius});
  return std::make_shared<const Scene>(writer.scene());
}

Shape shape_of(Volume volume) { return std::make_shared<const Volume>(std::move(volume)); }

MeshRequest at_spacing(double spacing) {
  MeshRequest request;
  request.spacing = spacing;
  return request;
}

TetMesh mesh_of(const Shape& shape, const MeshRequest& request) {
  TaskPool pool(2);
  auto made = mesh_volume(pool, {.shape = shape, .request = request});
  EXPECT_TRUE(made.ok()) << made.status();
  return made.ok() ? std::move(made->mesh) : TetMesh{};
}

std::vector<Fidelity> measure_all(const TetMesh& mesh,
                                  const Shape& shape,
                                  const MeshRequest& request,
                                  int threads = 2) {
  absl::StatusOr<std::vector<Fidelity>> measured = absl::UnknownError("not measured");
  TaskPool(threads).run([&] { measured = measure_fidelity(mesh, shape, request); });
  EXPECT_TRUE(measured.ok()) << measured.status();
  return measured.ok() ? *measured : std::vector<Fidelity>(1);
}

Fidelity measure(const TetMesh& mesh, const Shape& shape, const MeshRequest& request) {
  return measure_all(mesh, shape, request).front();
}

Fidelity of_ball(double radius, double spacing) {
  const Shape ball = ball_scene(radius);
  const MeshRequest request = at_spacing(spacing);
  return measure(mesh_of(ball, request), ball, request);
}

TEST(Fidelity, OfABallIsWhatItsChordsSay) {
  const Fidelity found = of_ball(1, 0.1);
  // Long edges have one spacing; cut ones up to that of the BCC lattice's face diagonal.
  const double deepest = 0.15 * 0.15 / 2;
  EXPECT_GT(found.to_surface.rms, 1e-4);
  EXPECT_LT(found.to_surface.rms, found.to_surface.max);
  EXPECT_LT(found.to_surface.max, deepest);
  EXPECT_LT(found.from_surface.max, deepest);
  EXPECT_NEAR(found.from_surface.rms, found.to_surface.rms, 0.1 * found.to_surface.rms);
  EXPECT_NEAR(found.surface_area, 4 * kPi, 0.02 * 4 * kPi);
  EXPECT_NEAR(found.mesh_area, 4 * kPi, 0.02 * 4 * kPi);
}

TEST(Fidelity, TellsTheVolumeThatPhiEnclosesMoreExactlyThanTheMesh) {
  const Fidelity found = of_ball(1, 0.1);
  const double exact = 4.0 / 3 * kPi;
  EXPECT_LT(found.mesh_volume, exact);
  EXPECT_LT(std::abs(*found.enclosed_volume - exact), 0.03 * (exact - found.mesh_volume));
}

TEST(Fidelity, FallsAsTheSquareOfTheSpacing) {
  const Fidelity coarse = of_ball(1, 0.1), fine = of_ball(1, 0.05);
  EXPECT_NEAR(coarse.to_surface.rms / fine.to_surface.rms, 4, 0.5);
  EXPECT_NEAR(coarse.from_surface.rms / fine.from_surface.rms, 4, 0.5);
}

TEST(Fidelity, KnowsTheVolumesOfKnownSolids) {
  for (const test::KnownScene& known : test::known_scenes()) {
    if (!(known.enclosed_volume > 0)) continue;
    const Shape shape = std::make_shared<const Scene>(known.scene);
    const MeshRequest request = at_spacing(known.spacing);
    const Fidelity found = measure(mesh_of(shape, request), shape, request);
    EXPECT_NEAR(*found.enclosed_volume, known.enclosed_volume, 0.01 * known.enclosed_volume)
        << known.name;
    EXPECT_LT(found.hausdorff(), known.spacing) << known.name;
  }
}

TEST(Fidelity, TakesTheVoxelsForTheTruthWhereTheLatticeIsCoarser) {
  const Shape ball = shape_of(test::ball(20));
  const double exact = 4.0 / 3 * kPi * 20 * 20 * 20;
  const MeshRequest fine = at_spacing(1), coarse = at_spacing(2.5);
  const Fidelity found = measure(mesh_of(ball, fine), ball, fine);
  const Fidelity rough = measure(mesh_of(ball, coarse), ball, coarse);
  EXPECT_NEAR(*found.enclosed_volume, exact, 2e-3 * exact);
  EXPECT_EQ(*found.enclosed_volume, *rough.enclosed_volume);
  EXPECT_LT(3 * found.to_surface.rms, rough.to_surface.rms);
}

/// Moves the vertex of the surface that is the farthest along x.
WorldPoint move_tip(TetMesh& mesh, double by) {
  std::uint64_t tip = 0;
  for (std::uint64_t v = 1; v < mesh.header.vertex_count; ++v) {
    if (mesh.vertex(v).x > mesh.vertex(tip).x) tip = v;
  }
  WorldPoint place = mesh.stored_position(tip);
  place.x += by;
  mesh.store_position(tip, place);
  return mesh.vertex(tip);
}

TEST(Fidelity, SeesOneVertexThatWasMoved) {
  for (const double spacing : {0.1, 0.03}) {  // more triangles than are sampled
    const Shape ball = ball_scene(1);
    const MeshRequest request = at_spacing(spacing);
    TetMesh mesh = mesh_of(ball, request);
    const Fidelity before = measure(mesh, ball, request);
    const WorldPoint tip = move_tip(mesh, 0.8 * spacing);
    const Fidelity after = measure(mesh, ball, request);
    EXPECT_LT(before.to_surface.max, 0.2 * spacing);
    EXPECT_NEAR(after.to_surface.max, 0.8 * spacing, 0.1 * spacing);
    EXPECT_EQ(after.to_surface.at, tip);
    EXPECT_EQ(after.enclosed_volume, before.enclosed_volume) << "the mesh was asked";
  }
}

TEST(Fidelity, SeesVerticesFarOutsideTheBandOfALevelSet) {
  const Shape ball = shape_of(test::ball(12));
  const MeshRequest request = at_spacing(1);
  TetMesh mesh = mesh_of(ball, request);
  move_tip(mesh, 20);
  EXPECT_NEAR(measure(mesh, ball, request).to_surface.max, 20, 1);
}

TEST(Fidelity, SeesAMeshThatWasShiftedAsAWhole) {
  const Shape ball = ball_scene(1);
  const MeshRequest request = at_spacing(0.1);
  TetMesh mesh = mesh_of(ball, request);
  mesh.header.origin.z += 0.05;
  const Fidelity found = measure(mesh, ball, request);
  EXPECT_NEAR(found.to_surface.max, 0.05, 0.01);
  EXPECT_NEAR(found.from_surface.max, 0.05, 0.01);
  EXPECT_NEAR(found.to_surface.rms, 0.05 / std::sqrt(3.0), 0.005);
}

TEST(Fidelity, SeesWhatTheMeshLacks) {
  test::SceneWriter writer;
  const std::string ball = writer.add(scene::Sphere{1});
  writer.add(
      scene::Combination{scene::Combine::kUnion, {ball, writer.add_moved({5, 0, 0}, ball)}, 0});
  const Shape two = std::make_shared<const Scene>(writer.scene());
  const MeshRequest request = at_spacing(0.1);
  const Fidelity found = measure(mesh_of(ball_scene(1), request), two, request);
  EXPECT_LT(found.to_surface.max, 0.02);
  EXPECT_NEAR(found.from_surface.max, 5, 0.02) << "from the farthest end to the ball's";
  EXPECT_NEAR(*found.enclosed_volume, 2 * found.mesh_volume, 0.05 * found.mesh_volume);
}

TEST(Fidelity, LooksAtTheSurfaceBetweenBothSidesAlone) {
  const Shape ball = shape_of(test::ball(12));
  MeshRequest request = at_spacing(1);
  request.preset = Preset::kBothSides;
  const Fidelity found = measure(mesh_of(ball, request), ball, request);
  EXPECT_LT(found.hausdorff(), 0.2);
  EXPECT_NEAR(found.mesh_area, 4 * kPi * 144, 0.02 * 4 * kPi * 144);
  EXPECT_NEAR(found.mesh_volume, 4.0 / 3 * kPi * 1728, 0.02 * 4.0 / 3 * kPi * 1728);
}

TEST(Fidelity, LeavesOutTheFacesOfABox) {
  const Shape ball = ball_scene(1);
  MeshRequest request = at_spacing(0.1);
  request.box = WorldBox{{-2, -2, 0}, {2, 2, 2}};
  const Fidelity found = measure(mesh_of(ball, request), ball, request);
  EXPECT_LT(found.hausdorff(), 0.02);
  EXPECT_NEAR(found.mesh_area, 2 * kPi, 0.03 * 2 * kPi);
  EXPECT_FALSE(found.enclosed_volume);
}

TEST(Fidelity, HoldsEachOfSeveralGridsAgainstItsOwn) {
  GridList grids;
  for (const double radius : {8.0, 14.0}) {
    Volume ball = test::ball(radius);
    ball.name = radius < 10 ? "small" : "large";
    grids.push_back(std::make_shared<const Volume>(std::move(ball)));
  }
  const Shape both = grids;
  const MeshRequest request = at_spacing(1);
  const auto found = measure_all(mesh_of(both, request), both, request);
  ASSERT_EQ(found.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const double radius = i == 0 ? 8 : 14, exact = 4.0 / 3 * kPi * radius * radius * radius;
    EXPECT_NEAR(*found[i].enclosed_volume, exact, 0.01 * exact);
    EXPECT_LT(found[i].hausdorff(), 0.3);
  }
}

TEST(Fidelity, LooksAtEachTriangleThatItMeasuresWhetherItIsToStop) {
  const Shape ball = ball_scene(1);
  const MeshRequest request = at_spacing(0.03);
  const TetMesh mesh = mesh_of(ball, request);
  const std::size_t triangles = surface_triangles(mesh).size();
  constexpr std::size_t kMeasured = kFidelitySamples / 7;
  ASSERT_GT(triangles, 2 * kMeasured) << "few of them are measured";
  std::atomic<std::size_t> looks = 0;
  const Cancellation cancellation(Cancellation::Clock::time_point::max(), [&] {
    ++looks;
    return false;
  });
  TaskPool(2).run(
      [&] { EXPECT_TRUE(measure_fidelity(mesh, ball, request, cancellation).ok()); });
  // And now and then while phi is asked of all, to know which are likely to be the worst.
  EXPECT_GE(looks, kMeasured + triangles / 256);
}

TEST(Fidelity, IsTheSameForAnyNumberOfThreads) {
  const Shape ball = ball_scene(1);
  const MeshRequest request = at_spacing(0.05);
  const TetMesh mesh = mesh_of(ball, request);
  const Fidelity one = measure_all(mesh, ball, request, 1).front();
  const Fidelity many = measure_all(mesh, ball, request, 7).front();
  EXPECT_EQ(one.to_surface.rms, many.to_surface.rms);
  EXPECT_EQ(one.to_surface.max, many.to_surface.max);
  EXPECT_EQ(one.from_surface.rms, many.from_surface.rms);
  EXPECT_EQ(one.from_surface.at, many.from_surface.at);
  EXPECT_EQ(*one.enclosed_volume, *many.enclosed_volume);
}

}  // namespace
}  // namespace tet
