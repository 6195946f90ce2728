// Meshes without what is told of them beside.
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/transfer/compact_mesh.h"
#include "tests/core/plan/meshing.h"
#include "tests/support/sanitized.h"
#include "tests/support/solids.h"

namespace tet::skipped_statistics_test {
namespace {

using Plan = std::shared_ptr<const MeshPlan>;

struct NamedRequest {
  std::string name;
  MeshRequest request;
};

/// Every way in which a mesh is made.
std::vector<NamedRequest> kinds_of_meshes() {
  MeshRequest uniform, improved, manifold, whole, both, cut, graded;
  uniform.levels = 0;
  improved.improve = true;
  manifold.manifold = true;
  whole.preset = both.preset = Preset::kBothSides;
  whole.box = {{-40, -40, -40}, {40, 40, 40}};
  both.box = {{-40, -40, -40}, {40, 40, 2}};  // cuts the surface
  cut.box = {{-40, -40, -40}, {40, 40, 2}};
  graded.sizing.coarsest = 8;
  graded.sizing.grade_surface = true;
  return {{"graded", {}},         {"uniform", uniform},         {"improved", improved},
          {"manifold", manifold}, {"all of both sides", whole}, {"both sides", both},
          {"cut", cut},           {"graded surface", graded}};
}

Plan plan(const Shape& shape,
          MeshRequest request,
          bool skip,
          const MeshPlan* earlier = nullptr) {
  request.skip_statistics = skip;
  auto made = plan_mesh({.shape = shape, .request = request, .earlier = earlier});
  EXPECT_TRUE(made.ok()) << made.status();
  return made.ok() ? *std::move(made) : nullptr;
}

Shape gyroid() {
  return std::make_shared<const Volume>(test::gyroid_ball(test::sanitized_or(24, 40)));
}

void expect_same_header(const MeshHeader& a, const MeshHeader& b) {
  EXPECT_EQ(a.chunk_count, b.chunk_count);
  EXPECT_EQ(a.origin, b.origin);
  EXPECT_EQ(a.bounds.min, b.bounds.min);
  EXPECT_EQ(a.bounds.max, b.bounds.max);
}

TEST(SkippedStatistics, LeaveEveryByteOfTheMeshAsItIs) {
  for (const auto& [name, request] : kinds_of_meshes()) {
    SCOPED_TRACE(name);
    const Plan with = plan(gyroid(), request, false), without = plan(gyroid(), request, true);
    ASSERT_TRUE(with && without);
    expect_same_header(without->header(), with->header());
    const auto measured = fill_mesh(*with, {}, nullptr),
               only = fill_mesh(*without, {}, nullptr);
    ASSERT_TRUE(measured.ok() && only.ok());
    EXPECT_TRUE(test::same_bytes(only->mesh, measured->mesh));
    EXPECT_FALSE(measured->quality.empty());
    EXPECT_TRUE(only->quality.empty());
    EXPECT_FALSE(without->boundary());
    EXPECT_EQ(without->thin_walls().inside, with->thin_walls().inside);
  }
}

TEST(SkippedStatistics, AreSkippedOfAWholeMeshInMemoryToo) {
  for (const bool improve : {false, true}) {
    MeshRequest request;
    request.improve = improve;
    const MeshResult measured = test::mesh(test::ball(12), request);
    request.skip_statistics = true;
    const MeshResult only = test::mesh(test::ball(12), request);
    EXPECT_TRUE(test::same_bytes(only.mesh, measured.mesh));
    EXPECT_TRUE(only.quality.empty());
    EXPECT_FALSE(only.boundary);
    EXPECT_TRUE(measured.boundary && !measured.quality.empty());
  }
}

TEST(SkippedStatistics, AreSkippedOfSeveralGridsToo) {
  const auto named = [](const char* name, Volume volume) {
    volume.name = name;
    return std::make_shared<const Volume>(std::move(volume));
  };
  const GridList grids{named("one", test::ball(9)), named("other", test::ball(12))};
  const Plan with = plan(grids, {}, false), without = plan(grids, {}, true);
  ASSERT_TRUE(with && without);
  EXPECT_EQ(with->statistics(), Statistics::kMeasured);
  EXPECT_EQ(without->statistics(), Statistics::kSkipped);
  EXPECT_TRUE(with->boundary());
  EXPECT_FALSE(without->boundary());
  const auto only = fill_mesh(*without, {}, nullptr);
  ASSERT_TRUE(only.ok());
  EXPECT_TRUE(only->quality.empty());
  EXPECT_TRUE(test::same_bytes(only->mesh, fill_mesh(*with, {}, nullptr)->mesh));
}

TEST(SkippedStatistics, AreNotMissedByAPlanThatBeginsWithOneWithout) {
  const Plan alone = plan(gyroid(), {}, false), without = plan(gyroid(), {}, true);
  ASSERT_TRUE(alone && without);
  const Plan after = plan(gyroid(), {}, false, without.get());
  ASSERT_TRUE(after);
  test::expect_same_plans(*after, *alone);
  const Plan without_after = plan(gyroid(), {}, true, alone.get());
  ASSERT_TRUE(without_after);
  EXPECT_FALSE(without_after->boundary());
}

TEST(SkippedStatistics, AreSkippedWhereCompactChunksAreMadeIntoAMesh) {
  const Plan with = plan(gyroid(), {}, false);
  ASSERT_TRUE(with);
  const CompactFrame frame = compact_frame(*as_bricks(*with));
  CompactBricks bricks(frame.rules.both_sides);
  MeshWorkspace workspace;
  for (std::uint64_t i = 0; i < with->header().chunk_count; ++i) {
    std::vector<std::byte> bytes;
    encode_chunk(*as_bricks(*with), i, workspace, bytes);
    ASSERT_TRUE(bricks.add(bytes).ok());
  }
  const auto decoded =
      decode_mesh(std::move(bricks), with->header(), frame, {}, {}, Statistics::kSkipped);
  ASSERT_TRUE(decoded.ok()) << decoded.status();
  EXPECT_TRUE(decoded->quality.empty());
  EXPECT_TRUE(test::same_bytes(decoded->mesh, fill_mesh(*with, {}, nullptr)->mesh));
}

}  // namespace
}  // namespace tet::skipped_statistics_test
