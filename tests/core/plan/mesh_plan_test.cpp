#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/plan/brick/brick_plan.h"
#include "core/plan/brick/fill_brick.h"
#include "core/plan/budget.h"
#include "core/plan/make/fill_mesh.h"
#include "core/plan/make/mesher.h"
#include "core/plan/make/plan_mesh.h"
#include "core/plan/mesh_progress.h"
#include "core/plan/prepared_mesh.h"
#include "tests/core/plan/meshing.h"
#include "tests/support/sanitized.h"
#include "tests/support/solids.h"
#include "tests/support/volume_fixtures.h"

namespace tet::mesh_plan_test {
namespace {

using test::mesh;

using ::testing::HasSubstr;

absl::StatusOr<std::shared_ptr<const MeshPlan>> plan(Volume volume,
                                                     const MeshRequest& request = {},
                                                     const MeshLimits& limits = {}) {
  return plan_mesh({.shape = std::make_shared<const Volume>(std::move(volume)),
                    .request = request,
                    .limits = limits});
}

std::vector<std::byte> chunk_bytes(const MeshPlan& plan,
                                   std::uint64_t index,
                                   MeshWorkspace& workspace) {
  const ChunkExtent extent = plan.chunk(index);
  const ChunkSizes size(plan.header(), extent);
  std::vector<std::byte> bytes(size.total());
  const std::span all(bytes);
  plan.fill_chunk(index, workspace,
                  {all.first(size.positions), all.subspan(size.positions, size.tets),
                   all.last(size.regions)});
  return bytes;
}

TEST(MeshPlan, CutsChunksThatJoinWithoutGapsAndStayWithinTheirSize) {
  const auto made = plan(test::ball(40));
  ASSERT_TRUE(made.ok()) << made.status();
  const MeshHeader& header = (*made)->header();
  ASSERT_GT(header.chunk_count, 5U);
  std::uint64_t vertices = 0, tets = 0;
  for (std::uint64_t i = 0; i < header.chunk_count; ++i) {
    const ChunkExtent chunk = (*made)->chunk(i);
    EXPECT_EQ(chunk.first_vertex, vertices);
    EXPECT_EQ(chunk.first_tet, tets);
    vertices += chunk.vertex_count;
    tets += chunk.tet_count;
    EXPECT_LE(chunk.vertex_count * 12 + chunk.tet_count * 16, kChunkBytes);
  }
  EXPECT_EQ(vertices, header.vertex_count);
  EXPECT_EQ(tets, header.tet_count);
}

TEST(MeshPlan, MakesAChunkTheSameWhateverTheWorkspaceMadeBefore) {
  const auto made = plan(test::random_signs(40, 8));
  ASSERT_TRUE(made.ok()) << made.status();
  const std::uint64_t chunks = (*made)->header().chunk_count;
  ASSERT_GT(chunks, 3U);
  MeshWorkspace used;
  for (std::uint64_t i = chunks; i-- > 0;) {
    MeshWorkspace fresh;
    EXPECT_EQ(chunk_bytes(**made, i, used), chunk_bytes(**made, i, fresh)) << "chunk " << i;
  }
}

TEST(MeshPlan, ChunksAddUpToTheStatisticsOfTheMeshToTheLastBit) {
  const auto made = plan(test::ball(40));
  ASSERT_TRUE(made.ok()) << made.status();
  TetMesh mesh((*made)->header());
  MeshWorkspace workspace;
  QualityStats sum;
  std::size_t most_bricks = 0;
  for (std::uint64_t i = 0; i < mesh.header.chunk_count; ++i) {
    sum.add((*made)->fill_chunk(i, workspace, mesh.columns_of((*made)->chunk(i))));
    const auto [begin, end] = as_bricks(**made)->bricks_of_chunk(i);
    most_bricks = std::max(most_bricks, end - begin);
  }
  ASSERT_GT(most_bricks, 2 * kBricksPerRun) << "no chunk is filled in parts";
  const auto filled = fill_mesh(**made, Cancellation(), nullptr);
  ASSERT_TRUE(filled.ok()) << filled.status();
  EXPECT_EQ(filled->quality.volume, sum.volume);
  EXPECT_EQ(filled->quality.min_dihedral_deg, sum.min_dihedral_deg);
  EXPECT_EQ(filled->quality.max_dihedral_deg, sum.max_dihedral_deg);
  EXPECT_EQ(filled->quality.histogram, sum.histogram);
}

TEST(MeshPlan, MakesTheSameBytesWhenItIsPlannedAgain) {
  const auto first = plan(test::ball(30)), second = plan(test::ball(30));
  ASSERT_TRUE(first.ok() && second.ok());
  MeshWorkspace workspace;
  const std::uint64_t last = (*first)->header().chunk_count - 1;
  for (const std::uint64_t i : {std::uint64_t{0}, last / 2, last}) {
    EXPECT_EQ(chunk_bytes(**first, i, workspace), chunk_bytes(**second, i, workspace));
  }
}

TEST(MeshPlan, StoresDoublesWhereFloatsWouldBendAngles) {
  const auto small = plan(test::ball(12));
  ASSERT_TRUE(small.ok());
  EXPECT_EQ((*small)->header().coordinate_type, CoordinateType::kFloat32);
  // Two small balls nine thousand voxels apart.
  const auto far =
      plan(test::narrow_band_volume({{-8, -8, -8}, {9008, 8, 8}}, 3, [](VoxelCoord v) {
        const double x = v.x < 4500 ? v.x : v.x - 9000;
        return static_cast<float>(std::hypot(x, v.y, v.z) - 5.2);
      }));
  ASSERT_TRUE(far.ok()) << far.status();
  EXPECT_EQ((*far)->header().coordinate_type, CoordinateType::kFloat64);
}

TEST(MeshPlan, MakesTheSameTetsWithWideIds) {
  MeshRequest wide;
  wide.indices = IndexType::kUint64;
  TaskPool pool(2);
  const auto volume = std::make_shared<const Volume>(test::ball(20));
  const auto make = [&](const MeshRequest& request) {
    auto result = mesh_volume(pool, {.shape = volume, .request = request});
    return std::move(result->mesh);
  };
  const TetMesh narrow_mesh = make({}), wide_mesh = make(wide);
  ASSERT_EQ(wide_mesh.header.index_type, IndexType::kUint64);
  ASSERT_EQ(wide_mesh.header.tet_count, narrow_mesh.header.tet_count);
  for (std::uint64_t i = 0; i < narrow_mesh.header.tet_count; ++i) {
    ASSERT_EQ(wide_mesh.tet(i), narrow_mesh.tet(i)) << "tet " << i;
  }
}

void expect_refusal(Volume volume,
                    const MeshRequest& request,
                    absl::StatusCode code,
                    const std::string& words,
                    const MeshLimits& limits = {}) {
  const auto made = plan(std::move(volume), request, limits);
  ASSERT_FALSE(made.ok()) << "not refused: " << words;
  EXPECT_EQ(made.status().code(), code) << made.status();
  EXPECT_THAT(std::string(made.status().message()), HasSubstr(words));
}

/// Vertices of a mesh beyond what its header says holds all.
std::uint64_t vertices_out_of_bounds(const TetMesh& mesh) {
  const WorldBox& box = mesh.header.bounds;
  std::uint64_t out = 0;
  for (std::uint64_t i = 0; i < mesh.header.vertex_count; ++i) {
    const WorldPoint p = mesh.vertex(i);
    const bool within = p.x >= box.min.x && p.x <= box.max.x && p.y >= box.min.y &&
                        p.y <= box.max.y && p.z >= box.min.z && p.z <= box.max.z;
    out += !within;
  }
  return out;
}

TEST(MeshPlan, BoundsHoldEveryVertex) {
  MeshRequest both_sides;
  both_sides.preset = Preset::kBothSides;
  const std::vector<Volume> volumes = [] {
    std::vector<Volume> all;
    for (const double radius : {7.7, 8.0, 8.3, 15.5}) all.push_back(test::ball(radius));
    for (const std::uint32_t seed : {1U, 2U, 3U}) all.push_back(test::random_signs(16, seed));
    return all;
  }();
  for (const Volume& volume : volumes) {
    EXPECT_EQ(vertices_out_of_bounds(mesh(volume, {}).mesh), 0U);
    for (const double end : {4.0, 200.0}) {  // the first cuts every surface
      both_sides.box = {{-200, -200, -200}, {end, end, end}};
      EXPECT_EQ(vertices_out_of_bounds(mesh(volume, both_sides).mesh), 0U) << end;
    }
  }
}

TEST(MeshPlan, BoundsOfBothSidesAreTheBoxWhereNoSurfaceCutsIt) {
  MeshRequest request;
  request.preset = Preset::kBothSides;
  request.box = {{-100, -100, -100}, {300, 100, 90}};
  const auto made = plan(test::ball(9), request);
  ASSERT_TRUE(made.ok()) << made.status();
  const WorldBox& bounds = (*made)->header().bounds;
  EXPECT_TRUE((bounds.min == WorldPoint{-104, -104, -104}));
  EXPECT_TRUE((bounds.max == WorldPoint{304, 104, 96}));
}

TEST(MeshPlan, MeshesABoxOfAnySizeOrRefusesItAtOnce) {
  MeshRequest request;
  request.preset = Preset::kBothSides;
  request.box = {{-1e7, -20, -20}, {1e7, 20, 20}};
  const auto made = plan(test::ball(9), request);
  ASSERT_TRUE(made.ok()) << made.status();
  EXPECT_LT((*made)->header().tet_count, 3'000'000U);
  request.levels = 6;
  const auto refused = plan(test::ball(9), request);
  EXPECT_EQ(refused.status().code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(refused.status().message()), HasSubstr("Use more levels"));
}

TEST(MeshPlan, SaysOfAGridWithoutASurfaceThatThereAreNoTwoSides) {
  for (const int levels : {0, 1, kMaxLevels}) {
    MeshRequest request;
    request.preset = Preset::kBothSides;
    request.levels = levels;
    request.box = {{-20, -20, -20}, {20, 20, 20}};
    request.iso = -7;
    const auto refused = plan(test::ball(9), request);
    EXPECT_EQ(refused.status().code(), absl::StatusCode::kFailedPrecondition);
    EXPECT_THAT(std::string(refused.status().message()),
                HasSubstr("nothing is inside at iso -7, so there are no two sides to mesh: the "
                          "grid's values are from "));
  }
}

TEST(MeshPlan, RefusesWhatItCannotMeshAndSaysWhy) {
  MeshRequest request;
  request.spacing = 0.0;
  expect_refusal(test::ball(6), request, absl::StatusCode::kInvalidArgument,
                 "spacing 0 is not a positive number");
  request.spacing = std::numeric_limits<double>::quiet_NaN();
  expect_refusal(test::ball(6), request, absl::StatusCode::kInvalidArgument, "spacing nan");
  request = {};
  request.levels = -1;
  expect_refusal(test::ball(6), request, absl::StatusCode::kInvalidArgument, "levels -1");
  request = {};
  request.iso = -10;
  expect_refusal(test::ball(6), request, absl::StatusCode::kFailedPrecondition,
                 "nothing is inside at iso -10");
  request.iso = 10;
  expect_refusal(test::ball(6), request, absl::StatusCode::kFailedPrecondition,
                 "the inside has no end");
}

TEST(MeshPlan, RefusesAMeshOverTheBudgetWithBothNumbers) {
  MeshRequest request;
  expect_refusal(test::ball(20), request, absl::StatusCode::kResourceExhausted,
                 "the limit is 1000", {.max_tets = 1000});
  request.levels = 0;
  expect_refusal(test::ball(20), request, absl::StatusCode::kResourceExhausted, "more levels",
                 {.max_tets = 1000});
  request.spacing = 1e-4;
  expect_refusal(test::ball(20), request, absl::StatusCode::kResourceExhausted,
                 "larger spacing");
}

TEST(MeshPlan, RefusesASurfaceThatItCouldNotKeepInMemory) {
  expect_refusal(test::ball(20), {}, absl::StatusCode::kResourceExhausted, "the limit is 39,",
                 {.max_plan_bytes = 100000});
}

TEST(MeshPlan, CountsInMemoryWhatALatticeFinerThanTheVoxelsHasOfTheSurface) {
  const Shape ball = std::make_shared<const Volume>(test::ball(14));
  MeshRequest request;
  request.spacing = test::sanitized_or(0.4, 0.25);
  MeshLimits limits{.max_plan_bytes = 1'000'000};
  absl::Status refused;
  while (true) {
    const auto made = plan_mesh({.shape = ball, .request = request, .limits = limits});
    if (made.ok()) break;
    refused = made.status();
    ASSERT_EQ(refused.code(), absl::StatusCode::kResourceExhausted);
    limits.max_plan_bytes += limits.max_plan_bytes / 2;
  }
  EXPECT_THAT(std::string(refused.message()), HasSubstr("bricks of 8^3 cells lie near"));
  const auto prepared = prepare_mesh(ball, request, limits, Cancellation());
  ASSERT_TRUE(prepared.ok());
  // Most that are looked at have no part in it.
  EXPECT_GT(prepared->bricks.near_surface.size(),
            2 * most_surface_bricks(prepared->space.rules, limits));
}

TEST(MeshPlan, PutsTheOriginOnTheLatticeCornerNextToWhereItIsAsked) {
  const VoxelTransform half = test::scaled(0.5);
  MeshRequest request;
  request.origin = WorldPoint{1.9, -2.1, 0.3};
  const MeshResult moved = test::mesh(test::ball(12, half), request);
  const MeshResult middle = test::mesh(test::ball(12, half));
  EXPECT_EQ(moved.mesh.header.origin, (WorldPoint{2, -2, 0.5}));
  EXPECT_NE(middle.mesh.header.origin, moved.mesh.header.origin);
  EXPECT_TRUE(std::ranges::equal(moved.mesh.tets.bytes(), middle.mesh.tets.bytes()));
  for (std::uint64_t i = 0; i < middle.mesh.header.vertex_count; i += 17) {
    const WorldPoint a = moved.mesh.vertex(i), b = middle.mesh.vertex(i);
    EXPECT_NEAR(a.x, b.x, 1e-5);
    EXPECT_NEAR(a.y, b.y, 1e-5);
    EXPECT_NEAR(a.z, b.z, 1e-5);
  }
}

TEST(MeshPlan, StoresFloat64WhereTheOriginIsFar) {
  MeshRequest request;
  request.origin = WorldPoint{5000, 0, 0};
  EXPECT_EQ(test::mesh(test::ball(9), request).mesh.header.coordinate_type,
            CoordinateType::kFloat64);
  request.origin = WorldPoint{1e30, 0, 0};
  expect_refusal(test::ball(9), request, absl::StatusCode::kInvalidArgument,
                 "origin (1e+30, 0, 0) is 1e+30 spacings");
}

TEST(MeshPlan, StopsWhenCancelledOrPastItsDeadline) {
  const auto volume = std::make_shared<const Volume>(test::ball(10));
  Cancellation cancelled;
  cancelled.cancel();
  EXPECT_EQ(plan_mesh({.shape = volume}, cancelled).status().code(),
            absl::StatusCode::kCancelled);
  const Cancellation late(Cancellation::Clock::now() - std::chrono::seconds(1));
  EXPECT_EQ(plan_mesh({.shape = volume}, late).status().code(),
            absl::StatusCode::kDeadlineExceeded);
}

TEST(MeshPlan, TellsProgressInBricks) {
  MeshProgress progress;
  const auto made = plan_mesh(
      {.shape = std::make_shared<const Volume>(test::ball(20)), .progress = &progress});
  ASSERT_TRUE(made.ok());
  EXPECT_GT(progress.total, 20U);
  EXPECT_EQ(progress.done, progress.total);
}

}  // namespace
}  // namespace tet::mesh_plan_test
