// The boundary's topology is counted with the mesh, and may be made a manifold.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/mesh/boundary.h"
#include "core/mesh/quality.h"
#include "core/plan/make/mesher.h"
#include "tests/core/plan/meshing.h"
#include "tests/support/conformity.h"
#include "tests/support/sanitized.h"
#include "tests/support/solids.h"
#include "tests/support/volume_fixtures.h"

namespace tet::surface_topology_test {
namespace {

using test::mesh;
using test::same_bytes;

/// Whole numbers near zero: half of all samples are exactly zero, and walls one voxel thick.
Volume few_values(int edge, std::uint32_t seed) {
  return test::dense_volume({{0, 0, 0}, {edge - 1, edge - 1, edge - 1}}, 3, [=](VoxelCoord v) {
    std::uint32_t hash = seed * 2654435761U;
    for (const std::int32_t c : {v.x, v.y, v.z}) {
      hash = (hash ^ static_cast<std::uint32_t>(c)) * 2246822519U;
      hash ^= hash >> 13U;
    }
    const int even = static_cast<int>(hash % 4) / 2 * 2, third = static_cast<int>(hash % 3);
    return static_cast<float>(even - third);
  });
}

/// A ball with single samples of its inside that are exactly zero: no surface is there.
Volume ball_with_lone_zeros() {
  constexpr float kRadius = 20;
  return test::dense_volume({{-24, -24, -24}, {24, 24, 24}}, 3, [](VoxelCoord v) {
    const auto square = [](std::int32_t i) { return static_cast<float>(i * i); };
    const float from_middle = std::sqrt(square(v.x) + square(v.y) + square(v.z));
    const bool lone = v.x % 5 == 0 && v.y % 6 == 0 && v.z % 7 == 0;
    return lone && from_middle < kRadius - 4 ? 0 : from_middle - kRadius;
  });
}

/// Sheets and walls of all thicknesses, rounded: where they meet bricks' edges and each other,
/// many samples are exactly zero.
Volume rounded_waves(std::uint32_t seed) {
  constexpr int kEdge = 28;
  const float steps = 0.7F + 0.6F * static_cast<float>(seed % 5);
  const float wave = 0.3F + 0.1F * static_cast<float>(seed % 4);
  const float phase = 1.7F * static_cast<float>(seed);
  return test::dense_volume(
      {{0, 0, 0}, {kEdge - 1, kEdge - 1, kEdge - 1}}, 3, [=](VoxelCoord v) {
        const auto along = [&](float i, float j) {
          return std::sin(wave * i + phase) * std::cos(wave * j - 0.3F * phase);
        };
        const auto x = static_cast<float>(v.x), y = static_cast<float>(v.y),
                   z = static_cast<float>(v.z);
        const float sum = along(x, y) + along(y, z) + along(z, x) + 0.2F * std::sin(phase);
        return std::round(steps * sum) / steps;
      });
}

/// A ball, solid or hollow, whose surface barely passes the corner where eight bricks meet:
/// some of them have a single node beyond it.
Volume ball_at_a_corner(std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto draw = [&](double low, double high) {
    return std::uniform_real_distribution(low, high)(random);
  };
  const double radius = draw(3, 9), beyond = draw(-0.6, 0.6);
  const bool hollow = seed % 2 == 1, rounded = seed % 3 == 0;
  std::array<double, 3> way{draw(-1, 1), draw(-1, 1), draw(-1, 1)};
  const double length = std::hypot(way[0], way[1], way[2]);
  for (double& along : way) along *= (radius + beyond) / length;
  return test::dense_volume({{-20, -20, -20}, {20, 20, 20}}, 3, [=](VoxelCoord v) {
    const double from_middle = std::hypot(v.x - way[0], v.y - way[1], v.z - way[2]);
    double phi = from_middle - radius;
    if (hollow) phi = std::max(-phi, std::hypot(v.x, v.y, v.z) - 19);
    return static_cast<float>(rounded ? std::round(4 * phi) / 4 : phi);
  });
}

std::vector<std::pair<std::string, Volume>> fields() {
  std::vector<std::pair<std::string, Volume>> all;
  for (test::Solid& solid : test::smooth_solids()) {
    all.emplace_back(solid.name, std::move(solid.volume));
  }
  all.emplace_back("gyroid", test::gyroid_ball(32));
  all.emplace_back("random signs", test::random_signs(14, 1));
  all.emplace_back("random signs and zeros", test::random_signs(14, 2, 3));
  all.emplace_back("random signs, mostly zeros", test::random_signs(14, 3, 2));
  all.emplace_back("few values", few_values(14, 4));
  all.emplace_back("ball with lone zeros", ball_with_lone_zeros());
  for (std::uint32_t seed = 0; seed < 8; ++seed) {
    all.emplace_back("rounded waves " + std::to_string(seed), rounded_waves(seed));
  }
  all.emplace_back("flipped tiles", test::ball_with_flipped_tiles(27));
  return all;
}

/// What was counted is what the finished mesh has.
void expect_counted_as_measured(const MeshResult& result) {
  ASSERT_TRUE(result.boundary.has_value());
  BoundaryTopology measured = measure_inside_boundary(result.mesh);
  measured.restored_nodes = result.boundary->restored_nodes;
  EXPECT_EQ(result.boundary->triangles, measured.triangles);
  EXPECT_EQ(result.boundary->vertices, measured.vertices);
  EXPECT_EQ(result.boundary->components, measured.components);
  EXPECT_EQ(result.boundary->euler_characteristic, measured.euler_characteristic);
  EXPECT_EQ(result.boundary->non_manifold_edges, measured.non_manifold_edges);
  EXPECT_EQ(result.boundary->non_manifold_vertices, measured.non_manifold_vertices);
}

TEST(SurfaceTopology, IsWhatTheFinishedMeshHas) {
  for (const auto& [name, volume] : test::few_of(fields(), 5)) {
    for (const bool manifold : {false, true}) {
      SCOPED_TRACE(name + (manifold ? ", manifold" : ""));
      MeshRequest request;
      request.manifold = manifold;
      expect_counted_as_measured(mesh(volume, request));
    }
  }
}

TEST(SurfaceTopology, HangsTogetherAcrossTheCornersOfBricks) {
  // Where it once did not, and where parts were once joined that are two.
  std::vector<std::uint32_t> seeds{122, 208, 400, 532, 856, 962, 20007, 23667, 23669};
  for (std::uint32_t seed = 0; seed < 20; ++seed) seeds.push_back(seed);
  for (const std::uint32_t seed : test::few_of(seeds, 8)) {
    SCOPED_TRACE(seed);
    expect_counted_as_measured(mesh(ball_at_a_corner(seed), {}));
  }
}

TEST(SurfaceTopology, OfBothSidesIsThatOfTheInside) {
  for (const auto& [name, volume] : test::few_of(fields(), 4)) {
    for (const bool manifold : {false, true}) {
      SCOPED_TRACE(name + (manifold ? ", manifold" : ""));
      MeshRequest request;
      request.preset = Preset::kBothSides;
      request.manifold = manifold;
      request.box = {{-64, -64, -64}, {64, 64, 64}};
      expect_counted_as_measured(mesh(volume, request));
    }
  }
}

TEST(SurfaceTopology, IsNotToldWhereABoxCutsTheSurface) {
  MeshRequest request;
  request.preset = Preset::kBothSides;
  request.box = {{-64, -64, -64}, {64, 64, 0}};
  EXPECT_FALSE(mesh(test::ball(15), request).boundary.has_value());
}

/// More bricks than are surveyed at a time.
TEST(SurfaceTopology, OfALargePlateIsThatOfASphere) {
  constexpr float kHalfEdge = 414.3F, kHalfThickness = 2.7F, kMiddle = 3.5F;
  const Volume plate =
      test::dense_volume({{-415, -415, 0}, {415, 415, 7}}, 3, [](VoxelCoord v) {
        const auto beyond = [](float i, float half) { return std::abs(i) - half; };
        return std::max({beyond(static_cast<float>(v.x), kHalfEdge),
                         beyond(static_cast<float>(v.y), kHalfEdge),
                         beyond(static_cast<float>(v.z) - kMiddle, kHalfThickness)});
      });
  const auto plan = plan_mesh({.shape = std::make_shared<const Volume>(plate)}).value();
  ASSERT_TRUE(plan->boundary().has_value());
  EXPECT_EQ(plan->boundary()->components, 1U);
  EXPECT_EQ(plan->boundary()->euler_characteristic, 2);
  EXPECT_EQ(plan->boundary()->non_manifold_edges, 0U);
}

TEST(ManifoldMesh, HasAManifoldBoundaryWithinTheBoundsOnEveryField) {
  auto harsh_fields = fields();
  std::erase_if(harsh_fields, [](const auto& field) {
    const std::string& name = field.first;
    return name != "gyroid" && !name.starts_with("random") && name != "few values";
  });
  for (const auto& [name, volume] : test::few_of(std::move(harsh_fields), 3)) {
    for (const Preset preset : {Preset::kDefault, Preset::kMinAngle, Preset::kBothSides}) {
      const bool harsh = name.starts_with("random");
      for (const int levels : harsh ? std::vector{0, kMaxLevels} : std::vector{kMaxLevels}) {
        SCOPED_TRACE(name + ", " + std::string(preset_name(preset)) + ", levels " +
                     std::to_string(levels));
        MeshRequest request;
        request.manifold = true;
        request.preset = preset;
        request.levels = levels;
        const MeshResult result = mesh(volume, request);
        const ConformityReport report = check_conformity(result.mesh);
        EXPECT_TRUE(report.conforming()) << report.describe();
        const QualityStats measured = measure_quality(result.mesh);
        const AngleBounds bounds = angle_bounds(preset, CoordinateType::kFloat64);
        EXPECT_GT(measured.min_dihedral_deg, bounds.min_deg);
        EXPECT_LT(measured.max_dihedral_deg, bounds.max_deg);
        if (!result.boundary) continue;  // both sides of a field that reaches the box
        EXPECT_EQ(result.boundary->non_manifold_edges, 0U);
        EXPECT_EQ(result.boundary->non_manifold_vertices, 0U);
      }
    }
  }
}

TEST(SurfaceTopology, TellsWhereRandomSignsAreNoManifold) {
  const MeshResult result = mesh(test::random_signs(20, 1), {});
  EXPECT_GT(result.boundary->non_manifold_edges, 100U);
  EXPECT_GT(result.boundary->non_manifold_vertices, 100U);
}

TEST(ManifoldMesh, TouchesNothingThatIsOneAlready) {
  for (const test::Solid& solid : test::smooth_solids()) {
    SCOPED_TRACE(solid.name);
    MeshRequest request;
    const MeshResult plain = mesh(solid.volume, request);
    request.manifold = true;
    const MeshResult manifold = mesh(solid.volume, request);
    EXPECT_EQ(manifold.boundary->restored_nodes, 0U);
    EXPECT_TRUE(same_bytes(plain.mesh, manifold.mesh));
  }
}

TEST(ManifoldMesh, IsTheSameForOneThreadAndForSixteen) {
  MeshRequest request;
  request.manifold = true;
  const Volume volume = test::random_signs(24, 6);
  const MeshResult one = mesh(volume, request, 1), many = mesh(volume, request, 16);
  EXPECT_GT(one.boundary->restored_nodes, 0U);
  EXPECT_TRUE(*one.boundary == *many.boundary);
  EXPECT_TRUE(same_bytes(one.mesh, many.mesh));
}

}  // namespace
}  // namespace tet::surface_topology_test
