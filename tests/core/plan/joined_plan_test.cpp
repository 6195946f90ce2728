// The meshes of several grids as one.
#include "core/plan/joined/joined_plan.h"

#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/plan/mesh_progress.h"
#include "core/scene/scene.h"
#include "tests/core/plan/meshing.h"
#include "tests/support/solids.h"
#include "tests/support/volume_fixtures.h"

namespace tet::joined_plan_test {
namespace {

using test::same_bytes;
using testing::HasSubstr;

std::shared_ptr<const Volume> named(const std::string& name, Volume volume) {
  volume.name = name;
  return std::make_shared<const Volume>(std::move(volume));
}

/// Voxels of `voxel`, turned about z and moved off every other lattice.
VoxelTransform turned(double voxel) {
  VoxelTransform transform;
  transform.linear = {
      {{0.8 * voxel, 0.6 * voxel, 0}, {-0.6 * voxel, 0.8 * voxel, 0}, {0, 0, voxel}}};
  transform.translation = {40.3, -7.1, 3.7};
  transform.voxel_size = voxel;
  return transform;
}

/// Two on one lattice, one of wider voxels, turned, and a density with voxels of its own.
GridList three_lattices() {
  Volume fog = test::fog_ball(9);
  fog.transform.translation = {-30.25, 11.5, 0.125};
  return {named("bone", test::ball(12)), named("joint", test::ball(9, turned(1.5))),
          named("marrow", test::ball(7)), named("skin", std::move(fog))};
}

/// Those of them that do not overlap.
GridList apart() {
  GridList grids = three_lattices();
  grids.erase(grids.begin() + 2);
  return grids;
}

absl::StatusOr<std::shared_ptr<const MeshPlan>> try_to_plan(const GridList& grids,
                                                            const MeshRequest& request = {},
                                                            const MeshLimits& limits = {},
                                                            MeshProgress* progress = nullptr,
                                                            int threads = 2) {
  absl::StatusOr<std::shared_ptr<const MeshPlan>> plan;
  TaskPool pool(threads);
  pool.run([&] {
    plan =
        plan_mesh({.shape = grids, .request = request, .limits = limits, .progress = progress});
  });
  return plan;
}

TetMesh filled(const MeshPlan& plan) {
  return fill_mesh(plan, Cancellation(), nullptr).value().mesh;
}

TetMesh alone(const std::shared_ptr<const Volume>& grid, const MeshRequest& request) {
  return filled(*plan_mesh({.shape = grid, .request = request}).value());
}

/// Where a part stores a vertex of a mesh that, made alone, has another origin.
WorldPoint stored(const TetMesh& one, std::uint64_t vertex, const MeshHeader& joined) {
  const WorldPoint p = one.stored_position(vertex);
  const WorldPoint &from = one.header.origin, &to = joined.origin;
  const auto moved = [&](double at, double a, double b) {
    const double place = at + (a - b);
    return joined.coordinate_type == CoordinateType::kFloat64
               ? place
               : static_cast<double>(static_cast<float>(place));
  };
  return {moved(p.x, from.x, to.x), moved(p.y, from.y, to.y), moved(p.z, from.z, to.z)};
}

/// Tet by tet and vertex by vertex, with the values of its fields.
void expect_part(const TetMesh& joined, const MeshPart& part, const TetMesh& one) {
  ASSERT_EQ(part.vertex_count, one.header.vertex_count);
  ASSERT_EQ(part.tet_count, one.header.tet_count);
  EXPECT_EQ(part.spacing, one.header.spacing);
  EXPECT_EQ(part.levels, one.header.levels);
  for (std::uint64_t i = 0; i < part.vertex_count; ++i) {
    ASSERT_EQ(joined.stored_position(part.first_vertex + i), stored(one, i, joined.header))
        << part.name << ", vertex " << i;
  }
  for (std::uint64_t i = 0; i < part.tet_count; ++i) {
    auto tet = one.tet(i);
    for (std::uint64_t& id : tet) id += part.first_vertex;
    ASSERT_EQ(joined.tet(part.first_tet + i), tet) << part.name << ", tet " << i;
  }
  const std::size_t row = joined.header.field_values() * sizeof(float);
  const auto values =
      joined.fields.bytes().subspan(part.first_vertex * row, part.vertex_count * row);
  EXPECT_TRUE(std::ranges::equal(values, one.fields.bytes())) << part.name;
}

/// Each part is what its grid alone has with this origin: in float64 where its lattice is
/// another than the first grid's.
void expect_each_alone(const GridList& grids, const MeshRequest& request) {
  const auto plan = try_to_plan(grids, request);
  ASSERT_TRUE(plan.ok()) << plan.status();
  const TetMesh joined = filled(**plan);
  ASSERT_EQ(joined.header.parts.size(), grids.size());
  std::uint64_t vertices = 0, tets = 0;
  for (std::size_t i = 0; i < grids.size(); ++i) {
    const MeshPart& part = joined.header.parts[i];
    MeshRequest one = request;
    one.origin = joined.header.origin;
    if (grids[i]->transform != grids[0]->transform) one.coordinates = CoordinateType::kFloat64;
    EXPECT_EQ(part.name, grids[i]->name);
    EXPECT_EQ(part.first_vertex, vertices);
    EXPECT_EQ(part.first_tet, tets);
    expect_part(joined, part, alone(grids[i], one));
    vertices += part.vertex_count;
    tets += part.tet_count;
  }
  EXPECT_EQ(joined.header.vertex_count, vertices);
  EXPECT_EQ(joined.header.tet_count, tets);
}

TEST(JoinedPlan, HasTheMeshThatEachGridHasAlone) {
  expect_each_alone(three_lattices(), {});
  MeshRequest uniform = test::with_levels(0);
  uniform.spacing = 1.25;
  expect_each_alone(three_lattices(), uniform);
  MeshRequest elsewhere;
  elsewhere.origin = {20.2, 0.3, -4.9};
  elsewhere.coordinates = CoordinateType::kFloat64;
  elsewhere.manifold = true;
  expect_each_alone(three_lattices(), elsewhere);
}

TEST(JoinedPlan, HasItAlsoImprovedAndWithAGradedSurface) {
  MeshRequest improved;
  improved.improve = true;
  expect_each_alone(three_lattices(), improved);
  MeshRequest graded;
  graded.sizing.coarsest = 4;
  graded.sizing.grade_surface = true;
  expect_each_alone(three_lattices(), graded);
}

TEST(JoinedPlan, HasItCutOffAtABox) {
  MeshRequest cut;
  cut.box = {{-60, -60, -3}, {60, 60, 60}};
  expect_each_alone(three_lattices(), cut);
  const auto plan = try_to_plan(three_lattices(), cut);
  ASSERT_TRUE(plan.ok()) << plan.status();
  const std::vector<FieldArray> arrays{{kCutFaceArray, 1}};
  EXPECT_EQ((*plan)->header().fields, arrays);
}

TEST(JoinedPlan, HasItWithTheValuesOfFields) {
  Volume values = test::dense_volume({{-50, -50, -20}, {60, 40, 20}}, -7, [](VoxelCoord v) {
    return static_cast<float>(v.x - v.y);
  });
  values.kind = VolumeKind::kField;
  MeshRequest request;
  request.fields = {{"heat", "", "", {named("heat", std::move(values))}}};
  expect_each_alone(three_lattices(), request);
}

TEST(JoinedPlan, IsTheSameForAnyThreadsAndAnyOrderOfChunks) {
  const auto one = try_to_plan(three_lattices(), {}, {}, nullptr, 1);
  ASSERT_TRUE(one.ok());
  const TetMesh whole = filled(**one);
  MeshLimits small;
  small.chunk_bytes = 30'000;
  const auto many = try_to_plan(three_lattices(), {}, small);
  ASSERT_TRUE(many.ok());
  const MeshHeader& header = (*many)->header();
  ASSERT_GT(header.chunk_count, 20U);
  TetMesh backwards(header);
  MeshWorkspace workspace;
  for (std::uint64_t i = header.chunk_count; i-- > 0;) {
    (*many)->fill_chunk(i, workspace, backwards.columns_of((*many)->chunk(i)));
  }
  EXPECT_TRUE(same_bytes(whole, backwards));
}

TEST(JoinedPlan, KeepsEachChunkAndEachTetWithinOnePart) {
  MeshLimits small;
  small.chunk_bytes = 30'000;
  const auto plan = try_to_plan(three_lattices(), {}, small);
  ASSERT_TRUE(plan.ok());
  const MeshHeader& header = (*plan)->header();
  const TetMesh mesh = filled(**plan);
  std::uint64_t next_vertex = 0, next_tet = 0;
  std::size_t part = 0;
  for (std::uint64_t i = 0; i < header.chunk_count; ++i) {
    const ChunkExtent chunk = (*plan)->chunk(i);
    EXPECT_EQ(chunk.first_vertex, next_vertex);
    EXPECT_EQ(chunk.first_tet, next_tet);
    next_vertex += chunk.vertex_count;
    next_tet += chunk.tet_count;
    const MeshPart* of = &header.parts[part];
    if (chunk.first_tet == of->first_tet + of->tet_count) of = &header.parts[++part];
    EXPECT_LE(next_tet, of->first_tet + of->tet_count);
    EXPECT_LE(next_vertex, of->first_vertex + of->vertex_count);
    for (std::uint64_t tet = chunk.first_tet; tet < next_tet; ++tet) {
      for (const std::uint64_t id : mesh.tet(tet)) {
        ASSERT_GE(id, of->first_vertex);
        ASSERT_LT(id - of->first_vertex, of->vertex_count);
      }
    }
  }
  EXPECT_EQ(next_vertex, header.vertex_count);
  EXPECT_EQ(next_tet, header.tet_count);
}

TEST(JoinedPlan, IsSoundAndSaysSo) {
  TaskPool pool(2);
  MeshRequest improved;
  improved.improve = true;
  for (const MeshRequest& request : {MeshRequest(), improved}) {
    const auto made = mesh_volume(pool, {.shape = apart(), .request = request});
    ASSERT_TRUE(made.ok()) << made.status();
    test::expect_sound(*made);
    ASSERT_TRUE(made->boundary);
    BoundaryTopology measured = measure_boundary(made->mesh);
    EXPECT_EQ(*made->boundary, measured);
    EXPECT_EQ(measured.components, 3U);
    EXPECT_NEAR(made->quality.volume, measure_quality(made->mesh).volume, 1e-3);
    EXPECT_EQ(made->improvement.has_value(), request.improve);
    const MeshHeader& header = made->mesh.header;
    EXPECT_EQ(header.spacing, 1);
    for (std::uint64_t i = 0; i < header.vertex_count; ++i) {
      const WorldPoint p = made->mesh.vertex(i);
      ASSERT_TRUE(header.bounds.min.x <= p.x && p.x <= header.bounds.max.x);
      ASSERT_TRUE(header.bounds.min.y <= p.y && p.y <= header.bounds.max.y);
      ASSERT_TRUE(header.bounds.min.z <= p.z && p.z <= header.bounds.max.z);
    }
  }
}

/// Away from the others by so many spacings.
GridList with_one_at(double x, bool same_lattice) {
  Volume far = test::ball(6);
  if (same_lattice) {
    const auto voxels = static_cast<std::int32_t>(x) / 8;
    for (BrickCoord& brick : far.bricks) brick.x += voxels;
    for (Region& region : far.regions) region.min.x += voxels;
    EXPECT_TRUE(far.cubes.empty());
  } else {
    far.transform.translation = {x, 0.5, 0};
  }
  return {named("near", test::ball(6)), named("far", std::move(far))};
}

TEST(JoinedPlan, StoresAllInFloat64WhereOneIsFarFromTheOrigin) {
  for (const bool same_lattice : {true, false}) {
    const auto near = try_to_plan(with_one_at(2048, same_lattice));
    const auto far = try_to_plan(with_one_at(8192, same_lattice));
    ASSERT_TRUE(near.ok() && far.ok()) << near.status() << far.status();
    EXPECT_EQ((*near)->header().coordinate_type, CoordinateType::kFloat32);
    EXPECT_EQ((*far)->header().coordinate_type, CoordinateType::kFloat64);
    expect_each_alone(with_one_at(2048, same_lattice), {});
    MeshRequest wide;
    wide.coordinates = CoordinateType::kFloat64;
    const TetMesh mesh = filled(**far);
    EXPECT_TRUE(same_bytes(mesh, filled(**try_to_plan(with_one_at(8192, same_lattice), wide))));
  }
}

TEST(JoinedPlan, CountsBricksOfAllGridsAsItsProgress) {
  MeshProgress progress;
  const auto plan = try_to_plan(three_lattices(), {}, {}, &progress);
  ASSERT_TRUE(plan.ok());
  EXPECT_GT(progress.total, 0U);
  EXPECT_EQ(progress.done, progress.total);
}

TEST(JoinedPlan, StopsWhereItIsCancelled) {
  Cancellation cancelled;
  cancelled.cancel();
  const auto plan = plan_mesh({.shape = three_lattices()}, cancelled);
  EXPECT_EQ(plan.status().code(), absl::StatusCode::kCancelled);
}

std::string refusal(const GridList& grids,
                    absl::StatusCode code,
                    const MeshRequest& request = {},
                    const MeshLimits& limits = {}) {
  const auto plan = try_to_plan(grids, request, limits);
  EXPECT_EQ(plan.status().code(), code) << plan.status();
  return std::string(plan.status().message());
}

TEST(JoinedPlan, IsRefusedOverTheLimitsOfAll) {
  const GridList two{named("a", test::ball(12)), named("b", test::ball(11))};
  const auto all = try_to_plan(two), first = try_to_plan({two[0]});
  ASSERT_TRUE(all.ok() && first.ok());
  MeshLimits limits;
  limits.max_tets = (*all)->header().tet_count;
  EXPECT_TRUE(try_to_plan(two, {}, limits).ok());
  --limits.max_tets;
  EXPECT_THAT(refusal(two, absl::StatusCode::kResourceExhausted, {}, limits),
              HasSubstr("(grid 'b', beside " + std::to_string((*first)->header().tet_count) +
                        " tets of other grids)"));
  limits = {};
  limits.max_plan_bytes = 10'000;
  while (!try_to_plan({two[0]}, {}, limits).ok()) {
    limits.max_plan_bytes += limits.max_plan_bytes / 10;
  }
  EXPECT_THAT(refusal(two, absl::StatusCode::kResourceExhausted, {}, limits),
              HasSubstr("lie near the surfaces of 2 grids; the limit is"));
}

TEST(JoinedPlan, NamesTheGridThatHasNothingInside) {
  MeshRequest request;
  request.iso = -2.5;
  const GridList grids{named("large", test::ball(14)), named("small", test::ball(2))};
  const std::string message = refusal(grids, absl::StatusCode::kFailedPrecondition, request);
  EXPECT_THAT(message, HasSubstr("nothing is inside at iso -2.5"));
  EXPECT_THAT(message, HasSubstr("(grid 'small')"));
}

TEST(JoinedPlan, KeepsTheFieldThatIsWrongInFront) {
  MeshRequest request;
  request.sizing.coarsest = 0.25;
  EXPECT_THAT(refusal(three_lattices(), absl::StatusCode::kInvalidArgument, request),
              testing::MatchesRegex("sizing\\..*\\(grid 'bone'\\)"));
}

TEST(JoinedPlan, TakesEachGridOnceAndTheInsideAlone) {
  const auto ball = named("ball", test::ball(5));
  constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;
  EXPECT_THAT(refusal({}, kInvalid), HasSubstr("grid_names has 0 entries; it takes 1 to 64"));
  EXPECT_THAT(refusal({ball, ball}, kInvalid),
              HasSubstr("grid_names[1] 'ball' is grid_names[0], too"));
  EXPECT_THAT(refusal({ball, named("", test::ball(5))}, kInvalid),
              HasSubstr("grid_names[1] is empty"));
  GridList many;
  for (int i = 0; i < 65; ++i) many.push_back(named(std::to_string(i), test::ball(3)));
  EXPECT_THAT(refusal(many, kInvalid), HasSubstr("grid_names has 65 entries"));
  many.pop_back();
  EXPECT_TRUE(try_to_plan(many).ok());
  MeshRequest both;
  both.preset = Preset::kBothSides;
  EXPECT_THAT(refusal({ball}, kInvalid, both), HasSubstr("preset both-sides"));
}

}  // namespace
}  // namespace tet::joined_plan_test
