// What an improved mesh promises, beside the same mesh without improvement.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/mesh/boundary.h"
#include "core/plan/make/mesher.h"
#include "core/volume/volume_reader.h"
#include "tests/core/plan/meshing.h"
#include "tests/support/conformity.h"
#include "tests/support/sanitized.h"
#include "tests/support/solids.h"

namespace tet::improved_mesh_test {
namespace {

using test::distance_from_surface;
using test::mesh;
using test::with_levels;

using ::testing::HasSubstr;

MeshRequest improving(MeshRequest request = {}) {
  request.improve = true;
  return request;
}

struct Field {
  std::string name;
  Volume volume;
};

std::vector<Field> resolved_fields() {
  std::vector<Field> fields;
  for (test::Solid& solid : test::smooth_solids()) {
    fields.push_back({solid.name, std::move(solid.volume)});
  }
  fields.push_back({"gyroid", test::gyroid_ball(40)});
  fields.push_back({"fog", test::fog_ball(12.2)});
  return fields;
}

MeshRequest both_sides(const MeshRequest& like = {}) {
  MeshRequest request = like;
  request.preset = Preset::kBothSides;
  return request;
}

std::vector<Field> all_fields() {
  std::vector<Field> fields = resolved_fields();
  fields.push_back({"random signs", test::random_signs(20, 1)});
  fields.push_back({"random signs and zeros", test::random_signs(20, 2, 3)});
  fields.push_back({"flipped tiles", test::ball_with_flipped_tiles(27)});
  return fields;
}

TEST(ImprovedMesh, HasAnglesOfTwentyDegreesAndMoreOnResolvedSolids) {
  for (const Field& field : test::few_of(resolved_fields(), 3)) {
    for (const int levels : {0, kMaxLevels}) {
      SCOPED_TRACE(field.name + ", levels " + std::to_string(levels));
      const QualityStats after =
          measure_quality(mesh(field.volume, improving(with_levels(levels))).mesh);
      EXPECT_GE(after.min_dihedral_deg, 20);
      EXPECT_LE(after.max_dihedral_deg, 145);
    }
  }
}

TEST(ImprovedMesh, NeverHasWorseAnglesNorOtherTets) {
  for (const Field& field : test::few_of(all_fields(), 4)) {
    const bool harsh = field.name.starts_with("random");
    for (const int levels : harsh ? std::vector{0, kMaxLevels} : std::vector{kMaxLevels}) {
      SCOPED_TRACE(field.name + ", levels " + std::to_string(levels));
      const MeshResult plain = mesh(field.volume, with_levels(levels));
      const MeshResult improved = mesh(field.volume, improving(with_levels(levels)));
      const QualityStats before = measure_quality(plain.mesh);
      const QualityStats after = measure_quality(improved.mesh);
      EXPECT_GE(after.min_dihedral_deg, before.min_dihedral_deg);
      EXPECT_LE(after.max_dihedral_deg, before.max_dihedral_deg);
      EXPECT_TRUE(std::ranges::equal(improved.mesh.tets.bytes(), plain.mesh.tets.bytes()));
      const ConformityReport report = check_conformity(improved.mesh);
      EXPECT_TRUE(report.conforming()) << report.describe();
    }
  }
}

TEST(ImprovedMesh, KeepsTheBoxAndTheSurfaceBetweenBothSides) {
  for (const Field& field :
       {Field{"ball", test::ball(17.3)}, Field{"gyroid", test::gyroid_ball(30)},
        Field{"random signs", test::random_signs(16, 1)}}) {
    SCOPED_TRACE(field.name);
    const MeshResult plain = mesh(field.volume, both_sides());
    const MeshResult improved = mesh(field.volume, improving(both_sides()));
    const QualityStats before = measure_quality(plain.mesh);
    const QualityStats after = measure_quality(improved.mesh);
    EXPECT_GE(after.min_dihedral_deg, before.min_dihedral_deg);
    EXPECT_LE(after.max_dihedral_deg, before.max_dihedral_deg);
    EXPECT_TRUE(std::ranges::equal(improved.mesh.regions.bytes(), plain.mesh.regions.bytes()));
    EXPECT_TRUE(check_conformity(improved.mesh).conforming());
    for (const Triangle& triangle : boundary_triangles(plain.mesh)) {
      for (const std::uint64_t v : triangle) {
        ASSERT_EQ(improved.mesh.stored_position(v), plain.mesh.stored_position(v));
      }
    }
    EXPECT_NEAR(after.volume, before.volume, 1e-6 * before.volume);
    EXPECT_GT(improved.improvement->moved_vertices, 0U);
  }
}

TEST(ImprovedMesh, ReportsWhatItsBytesHaveAndWhatTheyHadBefore) {
  for (const Field& field : test::few_of(all_fields(), 3)) {
    SCOPED_TRACE(field.name);
    const QualityStats before = measure_quality(mesh(field.volume, {}).mesh);
    const MeshResult improved = mesh(field.volume, improving());
    const QualityStats after = measure_quality(improved.mesh);
    EXPECT_EQ(improved.quality.min_dihedral_deg, after.min_dihedral_deg);
    EXPECT_EQ(improved.quality.max_dihedral_deg, after.max_dihedral_deg);
    EXPECT_EQ(improved.quality.histogram, after.histogram);
    EXPECT_NEAR(improved.quality.volume, after.volume, 1e-9 * after.volume);
    ASSERT_TRUE(improved.improvement.has_value());
    EXPECT_EQ(improved.improvement->min_dihedral_before_deg, before.min_dihedral_deg);
    EXPECT_EQ(improved.improvement->max_dihedral_before_deg, before.max_dihedral_deg);
    EXPECT_GT(improved.improvement->moved_vertices, 0U);
  }
}

TEST(ImprovedMesh, StaysOnTheSurfaceAndKeepsItsVolume) {
  for (const test::Solid& solid : test::smooth_solids()) {
    SCOPED_TRACE(solid.name);
    const MeshResult plain = mesh(solid.volume, {}), improved = mesh(solid.volume, improving());
    const auto [rms, largest] = distance_from_surface(solid.volume, improved.mesh);
    EXPECT_LT(rms, 2e-5);
    EXPECT_LT(largest, 1e-3);
    EXPECT_NEAR(improved.quality.volume, plain.quality.volume, 5e-4 * plain.quality.volume);
  }
}

TEST(ImprovedMesh, MovesNoVertexFartherThanHalfASpacing) {
  const Volume volume = test::random_signs(20, 1);
  const MeshResult plain = mesh(volume, {}), improved = mesh(volume, improving());
  double farthest = 0;
  std::uint64_t moved = 0;
  for (std::uint64_t v = 0; v < plain.mesh.header.vertex_count; ++v) {
    const Vector way = from_to(plain.mesh.stored_position(v), improved.mesh.stored_position(v));
    farthest = std::max(farthest, std::sqrt(dot(way, way)));
    moved += dot(way, way) > 0;
  }
  EXPECT_LE(farthest, 0.5 + 1e-6);
  EXPECT_EQ(moved, improved.improvement->moved_vertices);
}

TEST(ImprovedMesh, IsTheSameForAnyNumberOfThreads) {
  for (const Volume& volume : {test::ball(20), test::random_signs(24, 6)}) {
    const MeshResult one = mesh(volume, improving(), 1);
    for (const int threads : {2, 16}) {
      const MeshResult many = mesh(volume, improving(), threads);
      EXPECT_TRUE(std::ranges::equal(one.mesh.positions.bytes(), many.mesh.positions.bytes()));
      EXPECT_EQ(one.quality.volume, many.quality.volume);
      EXPECT_EQ(one.quality.histogram, many.quality.histogram);
    }
  }
}

TEST(ImprovedMesh, IsTheSameWhenItComesInChunks) {
  for (const Volume& field : {test::ball(30), test::random_signs(32, 8)}) {
    const auto volume = std::make_shared<const Volume>(field);
    const MeshResult whole = mesh(field, improving());
    const auto plan = plan_mesh({.shape = volume, .request = improving()});
    ASSERT_TRUE(plan.ok()) << plan.status();
    ASSERT_GT((*plan)->header().chunk_count, 2U);
    ASSERT_TRUE((*plan)->improvement().has_value());
    EXPECT_EQ((*plan)->improvement()->moved_vertices, whole.improvement->moved_vertices);
    const auto chunks = fill_mesh(**plan, Cancellation(), nullptr);
    ASSERT_TRUE(chunks.ok());
    EXPECT_TRUE(
        std::ranges::equal(chunks->mesh.positions.bytes(), whole.mesh.positions.bytes()));
    EXPECT_TRUE(std::ranges::equal(chunks->mesh.tets.bytes(), whole.mesh.tets.bytes()));
    EXPECT_EQ(chunks->quality.volume, whole.quality.volume);
    EXPECT_EQ(chunks->quality.histogram, whole.quality.histogram);
    EXPECT_EQ(chunks->quality.min_dihedral_deg, whole.quality.min_dihedral_deg);
  }
}

TEST(ImprovedMesh, IsTheSameAnywhereInIndexSpace) {
  const Volume near = test::ball(14);
  Volume far = near;
  constexpr std::int32_t kShift = 1 << 24;  // bricks
  for (BrickCoord& brick : far.bricks) brick.x += kShift;
  for (Region& region : far.regions) region.min.x += kShift;
  const MeshResult here = mesh(near, improving()), there = mesh(far, improving());
  EXPECT_GT(here.improvement->moved_vertices, 0U);
  EXPECT_TRUE(std::ranges::equal(here.mesh.positions.bytes(), there.mesh.positions.bytes()));
}

TEST(ImprovedMesh, KeepsItsAnglesUnderRotationMirrorAndDistance) {
  constexpr double kTurn = 0.6;
  VoxelTransform far;
  far.voxel_size = 0.04;
  far.linear = {{{-0.04 * std::cos(kTurn), -0.04 * std::sin(kTurn), 0},
                 {-0.04 * std::sin(kTurn), 0.04 * std::cos(kTurn), 0},
                 {0, 0, 0.04}}};
  far.translation = {20000, -20000, 500};
  const MeshResult moved = mesh(test::ball(15, far), improving());
  EXPECT_TRUE(check_conformity(moved.mesh).conforming());
  EXPECT_GE(measure_quality(moved.mesh).min_dihedral_deg, 20);
}

TEST(ImprovedMesh, WorksAtAnySpacing) {
  const Volume ball = test::ball(16);
  for (const double spacing : {0.6, 1.7, 2.5}) {
    SCOPED_TRACE(spacing);
    MeshRequest request;
    request.spacing = spacing;
    const MeshResult result = mesh(ball, improving(request));
    EXPECT_GE(result.quality.min_dihedral_deg, 20);
    EXPECT_LT(distance_from_surface(ball, result.mesh).first, 0.002 * spacing);
  }
}

TEST(ImprovedMesh, IsRefusedAsAPlanThatCouldNotHoldIt) {
  const auto volume = std::make_shared<const Volume>(test::ball(20));
  const MeshRequest uniform = with_levels(0);
  const MeshLimits limits{.max_plan_bytes = 8'000'000};
  ASSERT_TRUE(plan_mesh({.shape = volume, .request = uniform, .limits = limits}).ok());
  const auto plan =
      plan_mesh({.shape = volume, .request = improving(uniform), .limits = limits});
  EXPECT_EQ(plan.status().code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(plan.status().message()), HasSubstr("the limit is 8000000"));
}

}  // namespace
}  // namespace tet::improved_mesh_test
