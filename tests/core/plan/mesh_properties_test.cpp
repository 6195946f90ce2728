// What every mesh promises, on smooth solids and on the harshest fields.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/mesh/boundary.h"
#include "core/mesh/quality.h"
#include "core/plan/make/mesher.h"
#include "core/volume/volume_reader.h"
#include "tests/core/plan/meshing.h"
#include "tests/support/conformity.h"
#include "tests/support/reference_stuffing.h"
#include "tests/support/sanitized.h"
#include "tests/support/solids.h"
#include "tests/support/volume_fixtures.h"

namespace tet::mesh_properties_test {
namespace {

using test::distance_from_surface;
using test::mesh;
using test::same_bytes;
using test::with_levels;

using test::Solid;

/// What tests/certificate proves of the default preset.
const AngleBounds kBounds = angle_bounds(Preset::kDefault, CoordinateType::kFloat64);

struct Field {
  std::string name;
  Volume volume;
};

std::vector<Field> all_fields() {
  std::vector<Field> fields;
  for (Solid& solid : test::smooth_solids()) {
    fields.push_back({solid.name, std::move(solid.volume)});
  }
  fields.push_back({"gyroid", test::gyroid_ball(40)});
  fields.push_back({"random signs", test::random_signs(20, 1)});
  fields.push_back({"random signs and zeros", test::random_signs(20, 2, 3)});
  fields.push_back({"flipped tiles", test::ball_with_flipped_tiles(27)});
  fields.push_back({"fog", test::fog_ball(12.2)});
  return fields;
}

TEST(Mesh, ConformsWithPositiveTetsAndBoundedAnglesOnEveryField) {
  const std::vector<int> depths = test::few_of(std::vector{0, 1, 2, kMaxLevels}, 2);
  for (const Field& field : test::few_of(all_fields(), 4)) {
    for (const int levels : depths) {
      SCOPED_TRACE(field.name + ", levels " + std::to_string(levels));
      const MeshResult result = mesh(field.volume, with_levels(levels));
      const ConformityReport report = check_conformity(result.mesh);
      EXPECT_TRUE(report.conforming()) << report.describe();
      const QualityStats measured = measure_quality(result.mesh);
      EXPECT_GT(measured.min_dihedral_deg, kBounds.min_deg);
      EXPECT_LT(measured.max_dihedral_deg, kBounds.max_deg);
    }
  }
}

TEST(Mesh, ReportsTheQualityThatItsBytesHave) {
  for (const Field& field : test::few_of(all_fields(), 3)) {
    SCOPED_TRACE(field.name);
    const MeshResult result = mesh(field.volume);
    const QualityStats measured = measure_quality(result.mesh);
    EXPECT_NEAR(result.quality.min_dihedral_deg, measured.min_dihedral_deg, 1e-3);
    EXPECT_NEAR(result.quality.max_dihedral_deg, measured.max_dihedral_deg, 1e-3);
    EXPECT_NEAR(result.quality.volume, measured.volume, 1e-5 * measured.volume);
    std::uint64_t angles = 0;
    for (const std::uint64_t bin : result.quality.histogram) angles += bin;
    EXPECT_EQ(angles, 6 * result.mesh.header.tet_count);
  }
}

TEST(Mesh, HasTheTopologyAndTheVolumeOfResolvedSolids) {
  for (const Solid& solid : test::smooth_solids()) {
    for (const int levels : {0, kMaxLevels}) {
      SCOPED_TRACE(solid.name + ", levels " + std::to_string(levels));
      const MeshResult result = mesh(solid.volume, with_levels(levels));
      const BoundaryTopology boundary = measure_boundary(result.mesh);
      EXPECT_EQ(boundary.components, solid.components);
      EXPECT_EQ(boundary.euler_characteristic, solid.euler_characteristic);
      EXPECT_EQ(boundary.non_manifold_edges, 0U);
      EXPECT_EQ(boundary.non_manifold_vertices, 0U);
      EXPECT_NEAR(result.quality.volume, solid.enclosed_volume, 0.01 * solid.enclosed_volume);
    }
  }
}

TEST(Mesh, LiesOnTheSurface) {
  for (const Solid& solid : test::smooth_solids()) {
    SCOPED_TRACE(solid.name);
    const auto [rms, largest] = distance_from_surface(solid.volume, mesh(solid.volume).mesh);
    EXPECT_LT(rms, 1e-5);
    EXPECT_LT(largest, 1e-3);
  }
  const auto [rms, largest] = distance_from_surface(
      test::random_signs(16, 3), mesh(test::random_signs(16, 3), with_levels(0)).mesh);
  EXPECT_LT(rms, 0.02) << "cubics with three roots converge slowly, but they converge";
  EXPECT_LT(largest, 0.5);
}

/// Boundary triangles by the bits of their positions, sorted.
std::vector<std::array<std::array<double, 3>, 3>> surface_of(const TetMesh& mesh) {
  std::vector<std::array<std::array<double, 3>, 3>> surface;
  for (const Triangle& triangle : boundary_triangles(mesh)) {
    std::array<std::array<double, 3>, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) {
      const WorldPoint p = mesh.vertex(triangle[i]);
      corners[i] = {p.x, p.y, p.z};
    }
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()),
                corners.end());
    surface.push_back(corners);
  }
  std::sort(surface.begin(), surface.end());
  return surface;
}

TEST(Mesh, HasTheSameSurfaceGradedAndUniform) {
  for (const Field& field : test::few_of(all_fields(), 3)) {
    SCOPED_TRACE(field.name);
    const auto uniform = surface_of(mesh(field.volume, with_levels(0)).mesh);
    for (const int levels : {1, kMaxLevels}) {
      EXPECT_TRUE(surface_of(mesh(field.volume, with_levels(levels)).mesh) == uniform);
    }
  }
}

TEST(Mesh, IsNotFooledByInsideThatTheWarpTookAway) {
  // A slab up to y = 6.4, and at y = 8, in the bricks above it, grains so faint that their
  // nodes move onto the surface: a sample there is inside, and nothing is.
  const Volume volume = test::dense_volume({{0, 0, 0}, {31, 31, 31}}, 1, [](VoxelCoord v) {
    if (v.y < 8) return static_cast<float>(v.y) - 6.4F;
    const bool grain = v.y == 8 && v.x % 4 == 0 && v.z % 4 == 0;
    return grain ? -0.05F : 1.0F;
  });
  const TetMesh uniform = mesh(volume, with_levels(0)).mesh, graded = mesh(volume).mesh;
  EXPECT_TRUE(check_conformity(graded).conforming()) << check_conformity(graded).describe();
  EXPECT_TRUE(surface_of(graded) == surface_of(uniform));
}

TEST(Mesh, CountsWhatAnIndependentReadingOfTheRulesCounts) {
  const auto compare = [](const Volume& volume, const VoxelBox& box) {
    const MeshHeader header = mesh(volume, with_levels(0)).mesh.header;
    const test::ReferenceCounts expected = test::reference_counts(volume, box, 0.25, 0.35);
    EXPECT_EQ(header.vertex_count, expected.vertices);
    EXPECT_EQ(header.tet_count, expected.tets);
  };
  compare(test::ball(9.4), {{-12, -12, -12}, {12, 12, 12}});
  compare(test::random_signs(12, 4), {{0, 0, 0}, {11, 11, 11}});
  compare(test::random_signs(12, 5, 4), {{0, 0, 0}, {11, 11, 11}});
}

TEST(Mesh, HasManyTimesFewerTetsWhenGraded) {
  const Volume ball = test::ball(34);
  const double uniform = static_cast<double>(mesh(ball, with_levels(0)).mesh.header.tet_count);
  const double graded = static_cast<double>(mesh(ball).mesh.header.tet_count);
  EXPECT_GT(uniform / graded, 4);
}

TEST(Mesh, IsTheSameForOneThreadAndForSixteen) {
  for (const Volume& volume : {test::ball(20), test::random_signs(24, 6)}) {
    const MeshResult one = mesh(volume, {}, 1);
    const MeshResult many = mesh(volume, {}, 16);
    ASSERT_EQ(one.mesh.tets.size(), many.mesh.tets.size());
    EXPECT_TRUE(same_bytes(one.mesh, many.mesh));
    EXPECT_EQ(one.quality.volume, many.quality.volume);
  }
}

TEST(Mesh, IsTheSameAnywhereInIndexSpace) {
  // Moved by whole bricks the same floats are computed, so only the origin may differ.
  const Volume near = test::random_signs(16, 7);
  for (const std::int32_t shift : {1 << 20, -(1 << 25)}) {
    Volume far = near;
    for (BrickCoord& brick : far.bricks) brick = {brick.x + shift, brick.y - shift, brick.z};
    for (Region& region : far.regions) {
      region.min = {region.min.x + shift, region.min.y - shift, region.min.z};
    }
    const MeshResult here = mesh(near), there = mesh(far);
    EXPECT_TRUE(same_bytes(here.mesh, there.mesh));
    EXPECT_DOUBLE_EQ(there.mesh.header.origin.x - here.mesh.header.origin.x, 8.0 * shift);
  }
}

TEST(Mesh, KeepsItsAnglesUnderRotationMirrorAndDistance) {
  constexpr double kTurn = 0.6;
  VoxelTransform far;
  far.voxel_size = 0.04;
  // Turned about z, mirrored in x, and 20 km from the origin.
  far.linear = {{{-0.04 * std::cos(kTurn), -0.04 * std::sin(kTurn), 0},
                 {-0.04 * std::sin(kTurn), 0.04 * std::cos(kTurn), 0},
                 {0, 0, 0.04}}};
  far.translation = {20000, -20000, 500};
  const MeshResult plain = mesh(test::ball(15)), moved = mesh(test::ball(15, far));
  ASSERT_EQ(plain.mesh.header.tet_count, moved.mesh.header.tet_count);
  EXPECT_TRUE(check_conformity(moved.mesh).conforming()) << "mirrored tets must stay positive";
  EXPECT_NEAR(moved.quality.volume, plain.quality.volume * 6.4e-5, 1e-6);
  const QualityStats measured = measure_quality(moved.mesh);
  EXPECT_NEAR(measured.min_dihedral_deg, plain.quality.min_dihedral_deg, 0.01);
  EXPECT_NEAR(measured.max_dihedral_deg, plain.quality.max_dihedral_deg, 0.01);
}

TEST(Mesh, ResamplesAtAnySpacing) {
  const Volume ball = test::ball(16);
  for (const double spacing : {0.6, 1.7, 2.5}) {
    SCOPED_TRACE(spacing);
    MeshRequest request;
    request.spacing = spacing;
    const MeshResult result = mesh(ball, request);
    EXPECT_TRUE(check_conformity(result.mesh).conforming());
    EXPECT_EQ(result.mesh.header.spacing, spacing);
    EXPECT_GT(result.quality.min_dihedral_deg, kBounds.min_deg);
    EXPECT_LT(result.quality.max_dihedral_deg, kBounds.max_deg);
    EXPECT_EQ(measure_boundary(result.mesh).euler_characteristic, 2);
    EXPECT_NEAR(result.quality.volume, 4.0 / 3 * 3.14159265 * 16 * 16 * 16, 400);
    const auto [rms, largest] = distance_from_surface(ball, result.mesh);
    EXPECT_LT(rms, 0.01);
  }
}

}  // namespace
}  // namespace tet::mesh_properties_test
