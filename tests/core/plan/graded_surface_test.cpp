// Meshes whose surface is graded.
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "core/graded/graded_warp.h"
#include "core/plan/make/plan_mesh.h"
#include "core/stuffing/zero_bracket.h"
#include "core/transfer/mesh_patch.h"
#include "tests/core/plan/meshing.h"
#include "tests/support/graded_promises.h"
#include "tests/support/random_fields.h"
#include "tests/support/scenes.h"
#include "tests/support/solids.h"

namespace tet {
namespace {

using test::same_bytes;

/// A ball of radius 1 around the origin.
Shape ball_scene() {
  test::SceneWriter writer;
  writer.add(scene::Sphere{1});
  return std::make_shared<const Scene>(writer.scene());
}

MeshRequest graded(double spacing, double coarsest) {
  MeshRequest request;
  request.spacing = spacing;
  request.sizing.coarsest = coarsest;
  request.sizing.grade_surface = true;
  return request;
}

absl::StatusOr<MeshResult> try_to_mesh(const Shape& shape,
                                       const MeshRequest& request,
                                       const MeshLimits& limits = {}) {
  TaskPool pool(2);
  return mesh_volume(pool, {.shape = shape, .request = request, .limits = limits});
}

MeshResult mesh(const Shape& shape, const MeshRequest& request) {
  auto result = try_to_mesh(shape, request);
  EXPECT_TRUE(result.ok()) << result.status();
  return result.ok() ? *std::move(result) : MeshResult{};
}

double longest_edge(const TetMesh& mesh, const Triangle& triangle) {
  double longest = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector edge = from_to(mesh.vertex(triangle[i]), mesh.vertex(triangle[(i + 1) % 3]));
    longest = std::max(longest, std::sqrt(dot(edge, edge)));
  }
  return longest;
}

TEST(GradedSurface, IsOfOneSizeWhereNothingAsksForSmaller) {
  const MeshResult coarse = mesh(ball_scene(), graded(1.0 / 32, 1.0 / 8));
  MeshRequest uniform;
  uniform.spacing = 1.0 / 8;
  uniform.levels = 0;
  const MeshResult plain = mesh(ball_scene(), uniform);
  EXPECT_NEAR(static_cast<double>(coarse.mesh.header.tet_count),
              static_cast<double>(plain.mesh.header.tet_count),
              0.1 * static_cast<double>(plain.mesh.header.tet_count));
  EXPECT_NEAR(coarse.quality.volume, plain.quality.volume, 2e-3);
  EXPECT_EQ(coarse.mesh.header.levels, 2);
  EXPECT_EQ(coarse.boundary->euler_characteristic, 2);
}

/// The largest distance of the middle of a boundary edge from a ball's surface.
double worst_middle(const TetMesh& mesh, double radius) {
  double worst = 0;
  for (const Triangle& triangle : boundary_triangles(mesh)) {
    for (std::size_t i = 0; i < 3; ++i) {
      const WorldPoint a = mesh.vertex(triangle[i]), b = mesh.vertex(triangle[(i + 1) % 3]);
      const double reach = std::hypot((a.x + b.x) / 2, (a.y + b.y) / 2, (a.z + b.z) / 2);
      worst = std::max(worst, std::abs(radius - reach));
    }
  }
  return worst;
}

TEST(GradedSurface, FollowsABendAsCloselyAsItIsAsked) {
  std::uint64_t before = 0;
  for (const double error : {0.02, 0.005, 0.00125}) {
    MeshRequest request = graded(1.0 / 64, 1);
    request.sizing.chord_error = error;
    const MeshResult result = mesh(ball_scene(), request);
    EXPECT_TRUE(check_conformity(result.mesh).conforming());
    EXPECT_GT(result.quality.min_dihedral_deg, kLeastGradedAngleDeg);
    EXPECT_LT(worst_middle(result.mesh, 1), error);
    EXPECT_GT(worst_middle(result.mesh, 1), error / 8);  // leaves double
    EXPECT_GT(result.mesh.header.tet_count, before);
    before = result.mesh.header.tet_count;
  }
}

TEST(GradedSurface, IsFineOnlyWhereItBends) {
  test::SceneWriter writer;
  writer.add(scene::RoundedBox{{4, 4, 4}, 0.25});
  const Shape box = std::make_shared<const Scene>(writer.scene());
  MeshRequest even = graded(1.0 / 32, 1.0 / 16), bent = graded(1.0 / 32, 1);
  bent.sizing.chord_error = 0.004;
  const MeshResult fine = mesh(box, even), result = mesh(box, bent);
  EXPECT_LT(result.mesh.header.tet_count, fine.mesh.header.tet_count / 4);
  EXPECT_NEAR(result.quality.volume, fine.quality.volume, 0.05);
  EXPECT_GT(result.quality.min_dihedral_deg, kLeastGradedAngleDeg);
}

TEST(GradedSurface, KeepsWallsThatAreThinnerThanItsLargestLeaves) {
  test::SceneWriter writer;
  const std::string ball = writer.add(scene::Sphere{1});
  writer.add(scene::Shell{ball, 0.15});
  const Shape shell = std::make_shared<const Scene>(writer.scene());
  MeshRequest blind = graded(1.0 / 64, 1.0 / 4), seeing = blind;
  seeing.sizing.leaves_across = 2;
  const MeshResult result = mesh(shell, seeing);
  EXPECT_TRUE(check_conformity(result.mesh).conforming());
  EXPECT_GT(result.quality.min_dihedral_deg, kLeastGradedAngleDeg);
  EXPECT_EQ(result.boundary->components, 2U);
  EXPECT_EQ(result.boundary->euler_characteristic, 4);
  const auto missed = try_to_mesh(shell, blind);
  EXPECT_TRUE(!missed.ok() || missed->boundary->euler_characteristic != 4);
}

TEST(GradedSurface, IsFineInARegionAndCoarseElsewhere) {
  MeshRequest request = graded(1.0 / 64, 1.0 / 8);
  request.sizing.regions.push_back({1.0 / 64, BallRegion{{1, 0, 0}, 0.25}});
  const MeshResult result = mesh(ball_scene(), request);
  EXPECT_TRUE(check_conformity(result.mesh).conforming());
  EXPECT_GT(result.quality.min_dihedral_deg, kLeastGradedAngleDeg);
  // What is missing of a ball behind its facets: small ones miss less.
  EXPECT_NEAR(result.quality.volume, 4.0 / 3 * std::numbers::pi, 0.02);
  double coarsest = 0, in_region = 0;
  for (const Triangle& triangle : boundary_triangles(result.mesh)) {
    const WorldPoint p = result.mesh.vertex(triangle[0]);
    double& longest = std::hypot(p.x - 1, p.y, p.z) < 0.25 ? in_region : coarsest;
    longest = std::max(longest, longest_edge(result.mesh, triangle));
    EXPECT_NEAR(std::hypot(p.x, p.y, p.z), 1, 1e-6);
  }
  EXPECT_LT(in_region, 2.0 / 64);
  EXPECT_GT(coarsest, 1.0 / 8);
  EXPECT_LT(result.mesh.header.tet_count, 200'000U);
}

TEST(GradedSurface, KeepsAShellAlongItSmall) {
  MeshRequest request = graded(1.0 / 16, 1.0 / 2);
  request.sizing.regions.push_back({1.0 / 16, ShellRegion{1.0 / 64}});
  const MeshResult result = mesh(ball_scene(), request);
  for (const Triangle& triangle : boundary_triangles(result.mesh)) {
    EXPECT_LT(longest_edge(result.mesh, triangle), 2.0 / 16);
  }
}

TEST(GradedSurface, KeepsItsPromisesOnRandomInputs) {
  TaskPool pool(2);
  std::uint64_t tets = 0;
  const auto check = [&](const std::string& family, std::uint32_t seed) {
    const test::GradedCase given{family, seed, 14};
    const test::Outcome outcome = test::check_graded_promises(given, pool);
    EXPECT_EQ(outcome.violation, "") << test::arguments_of(given);
    tets += outcome.tets;
  };
  for (std::uint32_t seed = 4; seed <= 5; ++seed) {
    for (const std::string_view family : test::field_families())
      check(std::string(family), seed);
    check("scene", seed);
  }
  EXPECT_GT(tets, 50'000U);
}

TEST(GradedSurface, ComesInChunksAndInBetterShape) {
  MeshRequest request = graded(1.0 / 24, 1.0 / 6);
  request.sizing.regions.push_back({1.0 / 24, BallRegion{{1, 0, 0}, 0.4}});
  const MeshResult plain = mesh(ball_scene(), request);
  request.improve = true;
  const MeshResult improved = mesh(ball_scene(), request);
  EXPECT_GT(improved.quality.min_dihedral_deg, plain.quality.min_dihedral_deg + 5);
  MeshLimits limits;
  limits.chunk_bytes = 10'000;
  const auto plan = plan_mesh({.shape = ball_scene(), .request = request, .limits = limits});
  ASSERT_TRUE(plan.ok()) << plan.status();
  EXPECT_EQ(as_bricks(**plan), nullptr);
  EXPECT_GT((*plan)->header().chunk_count, 10U);
  const auto filled = fill_mesh(**plan, Cancellation(), nullptr);
  ASSERT_TRUE(filled.ok()) << filled.status();
  EXPECT_TRUE(same_bytes(filled->mesh, improved.mesh));
  EXPECT_EQ(MeshPatch::between(as_bricks(*plan), as_bricks(*plan), Cancellation()), nullptr)
      << "it is sent whole";
}

TEST(GradedSurface, IsRefusedWithTheField) {
  const auto refusal = [](const MeshRequest& request, const MeshLimits& limits = {}) {
    return std::string(try_to_mesh(ball_scene(), request, limits).status().message());
  };
  MeshRequest request = graded(0.1, 0.2);
  request.sizing.coarsest.reset();
  EXPECT_EQ(
      refusal(request),
      "sizing.coarsest must be set where grade_surface is: leaves at the surface are as long");
  request = graded(0.1, 0.2);
  request.manifold = true;
  EXPECT_EQ(refusal(request),
            "sizing.grade_surface does not go with manifold: set one of them");
  request = graded(0.1, 0.2);
  request.preset = Preset::kBothSides;
  EXPECT_EQ(refusal(request),
            "sizing.grade_surface is for the inside alone; preset both-sides meshes both "
            "sides: leave one of them out");
  MeshLimits limits;
  limits.max_tets = 1000;
  EXPECT_NE(refusal(graded(0.05, 0.05), limits).find("the limit is 1000"), std::string::npos);
  limits = {};
  limits.max_plan_bytes = 100'000;
  EXPECT_EQ(try_to_mesh(ball_scene(), graded(0.05, 0.1), limits).status().code(),
            absl::StatusCode::kResourceExhausted);
}

TEST(GradedSurface, StopsWhenItIsCancelled) {
  TaskPool pool(2);
  Cancellation cancelled;
  cancelled.cancel();
  const auto result =
      mesh_volume(pool, {.shape = ball_scene(), .request = graded(0.1, 0.2)}, cancelled);
  EXPECT_EQ(result.status().code(), absl::StatusCode::kCancelled);
}

}  // namespace
}  // namespace tet
