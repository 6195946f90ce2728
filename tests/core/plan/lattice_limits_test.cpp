// Where a lattice meets the limits of its numbers: far away, and on the surface to the bit.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/mesh/quality.h"
#include "core/mesh/tet_shapes.h"
#include "core/plan/budget.h"
#include "core/plan/make/plan_mesh.h"
#include "core/volume/label_volume.h"
#include "tests/core/plan/meshing.h"
#include "tests/support/conformity.h"
#include "tests/support/sanitized.h"
#include "tests/support/scenes.h"
#include "tests/support/solids.h"
#include "tests/support/volume_fixtures.h"

namespace tet {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

absl::Status refusal_of(Volume volume, const MeshRequest& request, const MeshLimits& limits) {
  return plan_mesh({.shape = std::make_shared<const Volume>(std::move(volume)),
                    .request = request,
                    .limits = limits})
      .status();
}

/// A ball of 12 voxels around (x, 0, 0).
Volume ball_at(std::int32_t x) {
  return test::narrow_band_volume({{x - 20, -20, -20}, {x + 20, 20, 20}}, 3, [=](VoxelCoord v) {
    const double away = std::hypot(v.x - x, v.y, v.z) - 12;
    return static_cast<float>(away);
  });
}

TEST(LatticeLimits, AGridTooFarAwayForItsSpacingIsRefused) {
  for (const double spacing : {0.1, 0.5}) {
    MeshRequest request;
    request.spacing = spacing;
    const absl::Status refused = refusal_of(ball_at(300'000'000), request, {});
    EXPECT_EQ(refused.code(), absl::StatusCode::kInvalidArgument) << "at spacing " << spacing;
    EXPECT_THAT(std::string(refused.message()), HasSubstr("spacings from its voxel 0"));
  }
}

TEST(LatticeLimits, AGridAtTheLimitIsMeshedAsItIsAnywhere) {
  for (const double spacing : {1.0, 0.6}) {
    MeshRequest request;
    request.spacing = spacing;
    const std::int32_t x = spacing == 1 ? 500'000'000 : 300'000'000;
    const MeshResult far = test::mesh(ball_at(x), request);
    EXPECT_TRUE(check_conformity(far.mesh).conforming());
    const double pi = std::acos(-1);
    EXPECT_NEAR(far.quality.volume, 4 * pi / 3 * 12 * 12 * 12, 100) << "at spacing " << spacing;
    double min = far.mesh.vertex(0).x, max = min;
    for (std::uint64_t i = 1; i < far.mesh.header.vertex_count; ++i) {
      min = std::min(min, far.mesh.vertex(i).x);
      max = std::max(max, far.mesh.vertex(i).x);
    }
    EXPECT_NEAR(max - min, 24, 1);
  }
}

// All of it is inside but for a speck that no node sees: a corner of the lattice lies on the
// speck's surface as closely as numbers can tell.
TEST(LatticeLimits, ABrickWhoseCornerIsNearlyOnTheSurfaceIsOnOneSideWhole) {
  struct Speck {
    double spacing;
    std::int32_t voxel;
    int levels;
  };
  for (const Speck& speck : {Speck{1.1125, 9, 0}, Speck{1.05625, 17, 1}}) {
    float value = 1.0F / 9;
    if (speck.voxel == 17) {
      const double at = 16 * speck.spacing;
      value = static_cast<float>((1 - (at - std::floor(at))) / (at - std::floor(at)));
    }
    // Sanitizers take ten times as long, and see nothing more in those beside it.
    const int steps = test::sanitized_or(0, 2);
    for (int step = -steps; step <= steps; ++step) {
      float stepped = value;
      for (int i = 0; i < std::abs(step); ++i) {
        stepped = std::nextafter(stepped, step < 0 ? 0.0F : 1.0F);
      }
      const auto solid = [&](VoxelCoord v) {
        if (v.x == speck.voxel && v.y == 0 && v.z == 0) return stepped;
        const int beyond =
            std::max({-16 - v.x, v.x - 48, -16 - v.y, v.y - 48, -16 - v.z, v.z - 48});
        return beyond > 0 ? 1.0F : -1.0F;
      };
      MeshRequest request;
      request.spacing = speck.spacing;
      request.levels = speck.levels;
      const MeshResult result =
          test::mesh(test::dense_volume({{-24, -24, -24}, {55, 55, 55}}, 1, solid), request);
      const ConformityReport report = check_conformity(result.mesh);
      EXPECT_TRUE(report.conforming()) << report.describe();
      EXPECT_NEAR(result.quality.volume, 65.0 * 65 * 65, 65.0 * 65 * 6 * 0.1)
          << "at spacing " << speck.spacing << ", " << step << " units beside it";
    }
  }
}

// Between voxels of one value there is that value, and not one that rounding made of it: all
// around the ball the voxels have the value of the surface itself.
TEST(LatticeLimits, APlateauAtTheValueOfTheSurfaceIsOnOneSideWhole) {
  const auto solid = [](VoxelCoord v) {
    return std::hypot(v.x, v.y, v.z) < 12 ? 50.0F : 100.0F;
  };
  for (const double spacing : {1.33, 1.07, 0.7}) {
    MeshRequest request;
    request.spacing = spacing;
    request.iso = 100;
    request.inside = InsideSide::kBelow;
    const MeshResult result =
        test::mesh(test::dense_volume({{-32, -32, -32}, {39, 39, 39}}, 100, solid), request);
    const ConformityReport report = check_conformity(result.mesh);
    EXPECT_TRUE(report.conforming()) << report.describe();
    // Cells that have a voxel of the ball belong to it up to their last corner.
    const auto volume = [pi = std::acos(-1)](double radius) {
      return 4 * pi / 3 * radius * radius * radius;
    };
    EXPECT_GT(result.quality.volume, volume(12)) << "at spacing " << spacing;
    EXPECT_LT(result.quality.volume, volume(13 + spacing / 2)) << "at spacing " << spacing;
    EXPECT_EQ(result.boundary->components, 1) << "at spacing " << spacing;
  }
}

// A brick of one sheet takes a third of what one of 64 blobs takes while it is counted.
TEST(LatticeLimits, ThePartsOfASurfaceCountForItsMemory) {
  const auto blobs = [](VoxelCoord v) {
    return v.x % 2 == 0 && v.y % 2 == 0 && v.z % 2 == 0 ? -1.0F : 1.0F;
  };
  const Volume volume = test::dense_volume({{0, 0, 0}, {63, 63, 63}}, 1, blobs);
  MeshRequest request;
  const MeshLimits limits{.max_plan_bytes = 2'600'000};
  const absl::Status refused = refusal_of(volume, request, limits);
  EXPECT_EQ(refused.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(refused.message()), HasSubstr("so many parts"));
  request.skip_statistics = true;
  EXPECT_EQ(refusal_of(volume, request, limits), absl::OkStatus());
}

// Its lattice coordinates have 32 bits, and its voxels' would have more.
TEST(LatticeLimits, ABoxTooFarAwayForItsVoxelsIsRefused) {
  MeshRequest request;
  request.preset = Preset::kBothSides;
  request.spacing = 200;
  const double far = std::ldexp(200.0, 27);
  request.box = WorldBox{{far, 0, 0}, {far + 1e4, 1e4, 1e4}};
  const absl::Status refused = refusal_of(ball_at(0), request, {});
  EXPECT_EQ(refused.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(refused.message()), HasSubstr("Use a nearer box"));
}

Shape one_label() {
  LabelVolumeBuilder builder("labels", {}, {{0, 0, 0}, {7, 7, 7}});
  std::array<std::int64_t, kBrickCells> values;
  values.fill(1);
  EXPECT_TRUE(builder.add_brick({0, 0, 0}, values).ok());
  return std::make_shared<const LabelVolume>(std::move(builder).build());
}

// Their positions were infinite, or all zero, and nothing said so.
TEST(LatticeLimits, SpacingsThatPositionsDoNotHoldAreRefusedOfEveryShape) {
  Volume named = test::ball(12);
  named.name = "ball";
  const auto ball = std::make_shared<const Volume>(std::move(named));
  test::SceneWriter writer;
  writer.add(scene::Sphere{1});
  MeshRequest plain, cut, graded, both, labels;
  cut.box = WorldBox{{-20, -20, 0}, {20, 20, 20}};
  graded.sizing.coarsest = 8;
  graded.sizing.grade_surface = true;
  both.preset = Preset::kBothSides;
  labels.labels = LabelChoice();
  const std::vector<std::pair<Shape, MeshRequest>> all{
      {ball, plain},
      {ball, cut},
      {ball, graded},
      {ball, both},
      {GridList{ball}, plain},
      {GridList{ball}, labels},
      {std::make_shared<const Scene>(writer.scene()), plain},
      {one_label(), labels}};
  for (const double spacing : {1e-46, 1e-29, 1e29, 1e50}) {
    for (const auto& [shape, asked] : all) {
      MeshRequest request = asked;
      request.spacing = spacing;
      const absl::Status refused = plan_mesh({.shape = shape, .request = request}).status();
      EXPECT_EQ(refused.code(), absl::StatusCode::kInvalidArgument) << spacing;
      EXPECT_THAT(std::string(refused.message()), HasSubstr("is not from 1e-28 to 1e+28"));
    }
  }
}

/// A ball of 12 voxels that are 2^power long.
MeshResult improved_ball(int power) {
  VoxelTransform transform;
  transform.voxel_size = std::ldexp(1.0, power);
  for (std::size_t i = 0; i < 3; ++i) transform.linear[i][i] = transform.voxel_size;
  MeshRequest request;
  request.improve = true;
  return test::mesh(test::ball(12, transform), request);
}

TEST(LatticeLimits, AMeshOfAnySizeIsThatOfAnyOtherButForItsUnit) {
  const MeshResult here = improved_ball(0);
  const QualityStats measured = measure_quality(here.mesh);
  for (const int power : {-92, -32, 32, 92}) {
    const MeshResult there = improved_ball(power);
    ASSERT_TRUE(std::ranges::equal(there.mesh.tets.bytes(), here.mesh.tets.bytes()));
    for (std::uint64_t i = 0; i < here.mesh.header.vertex_count; ++i) {
      const WorldPoint a = here.mesh.stored_position(i), b = there.mesh.stored_position(i);
      ASSERT_EQ(b, (WorldPoint{std::ldexp(a.x, power), std::ldexp(a.y, power),
                               std::ldexp(a.z, power)}));
    }
    EXPECT_EQ(there.quality.histogram, here.quality.histogram) << power;
    EXPECT_EQ(there.quality.volume, std::ldexp(here.quality.volume, 3 * power));
    EXPECT_EQ(measure_quality(there.mesh).histogram, measured.histogram) << power;
    EXPECT_EQ(there.improvement->moved_vertices, here.improvement->moved_vertices);
    const ShapeStats shapes = measure_shapes(there.mesh), before = measure_shapes(here.mesh);
    EXPECT_EQ(shapes.not_positive, 0U);
    EXPECT_EQ(shapes.scaled_jacobian.histogram, before.scaled_jacobian.histogram);
    EXPECT_EQ(shapes.radius_ratio.histogram, before.radius_ratio.histogram);
    EXPECT_EQ(shapes.edges.histogram, before.edges.histogram);
  }
}

TEST(LatticeLimits, MeshingWithoutStatisticsIsAdvisedWhereItHelps) {
  MeshedSpace space;
  space.most_bricks = 100;
  const auto advice = [&](const RareBytes& beside) {
    return std::string(check_survey_budget(50, beside, space).message());
  };
  EXPECT_THAT(advice({.parts = 1'000'000, .thin = 10}), HasSubstr("without statistics"));
  EXPECT_THAT(advice({.parts = 10, .thin = 1'000'000}), Not(HasSubstr("without statistics")));
  EXPECT_THAT(advice({.thin = 1'000'000}), HasSubstr("so many thin walls that"));
  EXPECT_EQ(advice({.parts = 10, .thin = 10}), "");
}

}  // namespace
}  // namespace tet
