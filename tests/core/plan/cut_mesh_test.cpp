// Meshes of an inside that a box cuts off.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <utility>

#include <gtest/gtest.h>

#include "core/graded/graded_warp.h"
#include "core/plan/make/plan_mesh.h"
#include "tests/core/plan/meshing.h"
#include "tests/support/cut_faces.h"
#include "tests/support/scenes.h"
#include "tests/support/solids.h"

namespace tet::cut_mesh_test {
namespace {

using test::cut_faces;
using test::same_bytes;

template <class Kind>
Shape scene_of(Kind kind) {
  test::SceneWriter writer;
  writer.add(std::move(kind));
  return std::make_shared<const Scene>(writer.scene());
}

Shape unit_ball() { return scene_of(scene::Sphere{1}); }

/// Half of a ball of radius 1, cut where x is 0.
MeshRequest half(double spacing) {
  MeshRequest request;
  request.spacing = spacing;
  request.box = WorldBox{{-2, -2, -2}, {0, 2, 2}};
  return request;
}

absl::StatusOr<MeshResult> try_to_mesh(const Shape& shape,
                                       const MeshRequest& request,
                                       int threads = 2,
                                       const MeshLimits& limits = {}) {
  TaskPool pool(threads);
  return mesh_volume(pool, {.shape = shape, .request = request, .limits = limits});
}

MeshResult mesh(const Shape& shape, const MeshRequest& request) {
  auto result = try_to_mesh(shape, request);
  EXPECT_TRUE(result.ok()) << result.status();
  return result.ok() ? *std::move(result) : MeshResult{};
}

void expect_sound(const MeshResult& result) {
  const ConformityReport report = check_conformity(result.mesh);
  EXPECT_TRUE(report.conforming()) << report.describe();
  const QualityStats measured = measure_quality(result.mesh);
  EXPECT_GT(measured.min_dihedral_deg, kLeastCutAngleDeg);
  EXPECT_LT(measured.max_dihedral_deg, kGreatestCutAngleDeg);
  EXPECT_EQ(*result.boundary, measure_boundary(result.mesh));
}

double area(const TetMesh& mesh, const Triangle& triangle) {
  const WorldPoint a = mesh.vertex(triangle[0]);
  const Vector normal =
      cross(from_to(a, mesh.vertex(triangle[1])), from_to(a, mesh.vertex(triangle[2])));
  return std::sqrt(dot(normal, normal)) / 2;
}

/// The area of the boundary's triangles in one face of the box.
double area_of_face(const TetMesh& mesh, CutFace face) {
  const auto faces = cut_faces(mesh);
  double sum = 0;
  for (const Triangle& triangle : boundary_triangles(mesh)) {
    if ((test::faces_of(faces, triangle) & face) != 0) sum += area(mesh, triangle);
  }
  return sum;
}

TEST(CutMesh, IsHalfOfABallWithAFlatFace) {
  for (const int levels : {0, 2, kMaxLevels}) {
    MeshRequest request = half(1.0 / 16);
    request.levels = levels;
    const MeshResult result = mesh(unit_ball(), request);
    expect_sound(result);
    EXPECT_NEAR(result.quality.volume, 2.0 / 3 * std::numbers::pi, 0.02);
    EXPECT_NEAR(area_of_face(result.mesh, kCutUpperX), std::numbers::pi, 0.02);
    EXPECT_EQ(area_of_face(result.mesh, kCutLowerX), 0);
    EXPECT_EQ(result.boundary->euler_characteristic, 2);
    EXPECT_EQ(result.boundary->components, 1U);
  }
}

TEST(CutMesh, SaysOfEveryVertexOfAFaceThatItLiesThere) {
  const MeshResult result = mesh(unit_ball(), half(1.0 / 16));
  const auto faces = cut_faces(result.mesh);
  ASSERT_EQ(faces.size(), result.mesh.header.vertex_count);
  for (std::uint64_t v = 0; v < faces.size(); ++v) {
    const double x = result.mesh.vertex(v).x;
    EXPECT_LE(x, 0);
    EXPECT_EQ(faces[v], x == 0 ? kCutUpperX : 0);
  }
}

TEST(CutMesh, IsOnTheSurfaceEverywhereElse) {
  const double spacing = 1.0 / 16;
  const MeshResult result = mesh(unit_ball(), half(spacing));
  const auto faces = cut_faces(result.mesh);
  for (const Triangle& triangle : boundary_triangles(result.mesh)) {
    if (test::faces_of(faces, triangle) != 0) continue;
    for (const std::uint64_t v : triangle) {
      const WorldPoint p = result.mesh.vertex(v);
      // A vertex of the rim that cannot move along the face stays a part of a spacing away.
      EXPECT_NEAR(std::hypot(p.x, p.y, p.z), 1, faces[v] != 0 ? 0.3 * spacing : 1e-6);
    }
  }
}

TEST(CutMesh, FillsABoxThatLiesInside) {
  MeshRequest request;
  request.spacing = 1.0 / 8;
  request.box = WorldBox{{-2, -1, 0}, {1, 1, 2}};
  const MeshResult result = mesh(scene_of(scene::Sphere{50}), request);
  expect_sound(result);
  EXPECT_NEAR(result.quality.volume, 3 * 2 * 2, 1e-9);
  for (const CutFace face : {kCutLowerX, kCutUpperX}) {
    EXPECT_NEAR(area_of_face(result.mesh, face), 4, 1e-9);
  }
  for (const CutFace face : {kCutLowerY, kCutUpperY, kCutLowerZ, kCutUpperZ}) {
    EXPECT_NEAR(area_of_face(result.mesh, face), 6, 1e-9);
  }
}

TEST(CutMesh, IsRoundedOutwardToEightSpacings) {
  MeshRequest request;
  request.spacing = 1.0 / 8;
  request.box = WorldBox{{0.1, 0.1, 0.1}, {0.9, 1.1, 2.0}};
  const MeshResult result = mesh(scene_of(scene::Sphere{50}), request);
  EXPECT_NEAR(result.quality.volume, 1 * 2 * 2, 1e-9);
}

TEST(CutMesh, GivesAnEndToWhatHasNone) {
  MeshRequest request;
  request.spacing = 1.0 / 16;
  request.box = WorldBox{{-1, -1, -1}, {1, 1, 1}};
  const MeshResult space = mesh(scene_of(scene::HalfSpace{{1, 2, 3}, 0}), request);
  expect_sound(space);
  EXPECT_NEAR(space.quality.volume, 4, 1e-3);
  const MeshResult sheet =
      mesh(scene_of(scene::PeriodicSurface{.period = 1, .thickness = 0.2}), request);
  expect_sound(sheet);
}

TEST(CutMesh, CutsVolumesAsItCutsScenes) {
  const Volume ball = test::ball(20);
  MeshRequest request;
  request.box = WorldBox{{0, -30, -30}, {30, 30, 30}};
  for (const double spacing : {1.0, 0.7}) {
    request.spacing = spacing;
    const MeshResult result = mesh(std::make_shared<const Volume>(ball), request);
    expect_sound(result);
    EXPECT_NEAR(result.quality.volume, 2.0 / 3 * std::numbers::pi * 8000, 800);
    EXPECT_GT(area_of_face(result.mesh, kCutLowerX), 1000);
  }
}

TEST(CutMesh, IsTheSameForAnyThreadsAndChunks) {
  MeshRequest request = half(1.0 / 12);
  const MeshResult result = mesh(unit_ball(), request);
  const auto alone = try_to_mesh(unit_ball(), request, 1);
  ASSERT_TRUE(alone.ok());
  EXPECT_TRUE(same_bytes(result.mesh, alone->mesh));
  MeshLimits limits;
  limits.chunk_bytes = 10'000;
  const auto parts = try_to_mesh(unit_ball(), request, 2, limits);
  ASSERT_TRUE(parts.ok());
  EXPECT_TRUE(same_bytes(result.mesh, parts->mesh));
}

TEST(CutMesh, StaysFlatWhereItIsImproved) {
  MeshRequest request = half(1.0 / 12);
  const MeshResult plain = mesh(unit_ball(), request);
  request.improve = true;
  const MeshResult improved = mesh(unit_ball(), request);
  expect_sound(improved);
  EXPECT_GT(improved.improvement->moved_vertices, 0U);
  const auto faces = cut_faces(plain.mesh);
  EXPECT_EQ(cut_faces(improved.mesh), faces);
  for (std::uint64_t v = 0; v < faces.size(); ++v) {
    if (faces[v] != 0) {
      EXPECT_EQ(improved.mesh.vertex(v).x, 0);
    }
  }
}

TEST(CutMesh, MayBeGradedAtItsSurfaceAndItsFaces) {
  MeshRequest request = half(1.0 / 32);
  request.sizing.coarsest = 1.0 / 8;
  request.sizing.grade_surface = true;
  request.sizing.regions.push_back({1.0 / 32, BallRegion{{0, 1, 0}, 0.2}});
  const MeshResult result = mesh(unit_ball(), request);
  expect_sound(result);
  EXPECT_NEAR(area_of_face(result.mesh, kCutUpperX), std::numbers::pi, 0.02);
  EXPECT_LT(result.mesh.header.tet_count, 100'000U);
}

TEST(CutMesh, ComesWithFieldsBeforeItsOwn) {
  MeshRequest request = half(1.0 / 8);
  VertexField field;
  field.name = "heat";
  field.components = {std::make_shared<const Volume>(test::ball(10))};
  request.fields.push_back(field);
  const MeshResult result = mesh(unit_ball(), request);
  ASSERT_EQ(result.mesh.header.fields.size(), 2U);
  EXPECT_EQ(result.mesh.header.fields[0].name, "heat");
  const auto faces = cut_faces(result.mesh);
  EXPECT_GT(std::ranges::count(faces, kCutUpperX), 20);
  // Also of a mesh without a cut, or its readers would take the field for one.
  request.fields[0].name = kCutFaceArray;
  request.box.reset();
  EXPECT_EQ(try_to_mesh(unit_ball(), request).status().message(),
            "fields[0].name \"cut_face\" is that of the array that tells the faces of a box: "
            "call the field otherwise");
}

TEST(CutMesh, IsRefusedWithItsReason) {
  MeshRequest request = half(1.0 / 8);
  request.manifold = true;
  EXPECT_EQ(try_to_mesh(unit_ball(), request).status().message(),
            "manifold does not go with a box that cuts the inside: set one of them");
  request = half(1.0 / 8);
  request.box = WorldBox{{3, 3, 3}, {4, 4, 4}};
  const auto empty = try_to_mesh(unit_ball(), request);
  EXPECT_EQ(empty.status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(
      empty.status().message(),
      "nothing in the box is inside at iso 0, so there is nothing to mesh; move the box, or "
      "a solid thinner than spacing 0.125 needs a smaller one");
}

}  // namespace
}  // namespace tet::cut_mesh_test
