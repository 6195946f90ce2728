#include "core/transfer/mesh_patch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <random>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/mesh/row_queue.h"
#include "tests/core/plan/meshing.h"
#include "tests/support/sanitized.h"
#include "tests/support/solids.h"
#include "tests/support/volume_fixtures.h"

namespace tet::mesh_patch_test {
namespace {

using test::same_bytes;
using Plan = std::shared_ptr<const MeshPlan>;

Plan plan_of(const Volume& volume, const MeshRequest& request, const MeshLimits& limits = {}) {
  const auto plan = plan_mesh(
      {.shape = std::make_shared<const Volume>(volume), .request = request, .limits = limits});
  EXPECT_TRUE(plan.ok()) << plan.status();
  return plan.ok() ? *plan : nullptr;
}

std::shared_ptr<const MeshPatch> patch_between(const Plan& earlier,
                                               const Plan& now,
                                               PatchDetail detail = PatchDetail::kBricks) {
  return MeshPatch::between(as_bricks(earlier), as_bricks(now), detail);
}

TetMesh mesh_of(const MeshPlan& plan) {
  return std::move(fill_mesh(plan, Cancellation(), nullptr)->mesh);
}

/// The mesh of `now` from that of `earlier` and the patches.
TetMesh spliced(const TetMesh& earlier,
                const MeshPlan& now,
                const MeshPatch& patch,
                TetMesh used = {}) {
  absl::StatusOr<TetMesh> mesh =
      splice_mesh(earlier, now.header(), patch.kept(), std::move(used));
  EXPECT_TRUE(mesh.ok()) << mesh.status();
  if (!mesh.ok()) return {};
  MeshWorkspace workspace;
  RowQueue vertices = RowQueue::beside(patch.kept().vertices, now.header().vertex_count);
  RowQueue tets = RowQueue::beside(patch.kept().tets, now.header().tet_count);
  for (std::uint64_t i = 0; i < patch.patch_count(); ++i) {
    const ChunkExtent extent = patch.extent(i);
    if (!patch.kept().loose) {
      patch.fill(i, workspace, mesh->columns_of(extent));
      continue;
    }
    TetMesh chunk(header_of_chunk(now.header(), extent));
    patch.fill(i, workspace, chunk.columns());
    const auto copy = [&](std::uint64_t row, std::uint64_t at, std::uint64_t count) {
      const ChunkColumns from = chunk.columns_of({.first_tet = at, .tet_count = count});
      const ChunkColumns to = mesh->columns_of({.first_tet = row, .tet_count = count});
      std::ranges::copy(from.tets, to.tets.begin());
      std::ranges::copy(from.regions, to.regions.begin());
    };
    EXPECT_TRUE(tets.take(extent.tet_count, copy));
    const auto copy_points = [&](std::uint64_t row, std::uint64_t at, std::uint64_t count) {
      const auto from = chunk.columns_of({.first_vertex = at, .vertex_count = count}).positions;
      const auto to = mesh->columns_of({.first_vertex = row, .vertex_count = count}).positions;
      std::ranges::copy(from, to.begin());
    };
    EXPECT_TRUE(vertices.take(extent.vertex_count, copy_points));
  }
  const auto nothing = [](std::uint64_t, std::uint64_t, std::uint64_t) {};
  if (patch.kept().loose) {
    EXPECT_FALSE(vertices.take(1, nothing) || tets.take(1, nothing));
  }
  return *std::move(mesh);
}

constexpr std::array kDetails{PatchDetail::kWhole, PatchDetail::kBricks, PatchDetail::kSlices};

std::uint64_t kept_tets(const MeshPatch& patch) {
  std::uint64_t count = 0;
  for (const KeptRun& run : patch.kept().tets) count += run.count;
  return count;
}

/// A ball of 30 voxels with a dent or a bump of a few voxels at one place.
Volume dented_ball(float depth, VoxelCoord at = {0, 0, 30}) {
  return test::narrow_band_volume(
      VoxelBox{VoxelCoord{-40, -40, -40}, VoxelCoord{40, 40, 40}}, 3, [=](VoxelCoord v) {
        const auto from = [&](VoxelCoord c) {
          return std::sqrt(static_cast<float>((v.x - c.x) * (v.x - c.x) +
                                              (v.y - c.y) * (v.y - c.y) +
                                              (v.z - c.z) * (v.z - c.z)));
        };
        const float ball = from({0, 0, 0}) - 30;
        return depth == 0 ? ball : std::max(ball, depth - from(at));
      });
}

struct Case {
  std::string name;
  Volume earlier, now;
  MeshRequest request;
};

std::vector<Case> cases() {
  MeshRequest graded, uniform, manifold, both_sides, steps;
  uniform.levels = 0;
  manifold.manifold = true;
  both_sides.preset = Preset::kBothSides;
  steps.spacing = 1.3;
  const Volume ball = dented_ball(0), dented = dented_ball(5),
               inner = dented_ball(6, {0, 9, 9});
  std::vector<Case> cases;
  const auto add = [&](const char* name, const Volume& earlier, const Volume& now,
                       const MeshRequest& request) {
    cases.push_back({name, earlier, now, request});
  };
  add("a dent", ball, dented, graded);
  add("a dent, uniform", ball, dented, uniform);
  add("a dent, manifold", ball, dented, manifold);
  add("a dent, both sides", ball, dented, both_sides);
  add("a dent, other steps", ball, dented, steps);
  add("a dent mended", dented, ball, graded);
  add("a hole within", ball, inner, graded);
  add("nothing", ball, ball, graded);
  add("signs", test::random_signs(24, 8), test::random_signs(24, 9), graded);
  return cases;
}

TEST(MeshPatch, MakesTheSameBytesAsTheWholeMesh) {
  for (const Case& c : test::few_of(cases(), 5)) {
    SCOPED_TRACE(c.name);
    const Plan earlier = plan_of(c.earlier, c.request), now = plan_of(c.now, c.request);
    ASSERT_TRUE(earlier && now);
    for (const PatchDetail detail : kDetails) {
      const auto patch = patch_between(earlier, now, detail);
      if (patch == nullptr) {
        EXPECT_FALSE(can_splice(earlier->header(), now->header()));
        continue;
      }
      EXPECT_TRUE(same_bytes(spliced(mesh_of(*earlier), *now, *patch), mesh_of(*now)));
    }
  }
}

TEST(MeshPatch, MakesTheSameBytesWhereverTheChangeIs) {
  std::mt19937 random(7);
  const auto coordinate = [&] { return static_cast<std::int32_t>(random() % 61) - 30; };
  for (int turn = 0; turn < test::sanitized_or(3, 8); ++turn) {
    SCOPED_TRACE(turn);
    MeshRequest request;
    request.preset = turn % 3 == 0 ? Preset::kBothSides : Preset::kDefault;
    if (turn % 2 != 0) request.spacing = 0.9;
    const float depth = static_cast<float>(random() % 12) / 2;
    const VoxelCoord at{coordinate(), coordinate(), coordinate()};
    const Plan earlier = plan_of(dented_ball(0), request);
    const Plan now = plan_of(dented_ball(depth, at), request);
    ASSERT_TRUE(earlier && now);
    for (const PatchDetail detail : kDetails) {
      const auto patch = patch_between(earlier, now, detail);
      ASSERT_TRUE(patch);
      EXPECT_TRUE(same_bytes(spliced(mesh_of(*earlier), *now, *patch), mesh_of(*now)));
    }
  }
}

/// Tets of a mesh by where their corners lie, and on which side they are.
using Shapes = std::set<std::pair<std::array<std::array<double, 3>, 4>, MeshRegion>>;

Shapes shapes_of(const TetMesh& mesh) {
  Shapes shapes;
  for (std::uint64_t i = 0; i < mesh.header.tet_count; ++i) {
    std::array<std::array<double, 3>, 4> corners;
    std::ranges::transform(mesh.view().stored_places(i), corners.begin(),
                           [](const WorldPoint& at) {
                             return std::array{at.x, at.y, at.z};
                           });
    shapes.emplace(corners, mesh.region(i));
  }
  return shapes;
}

/// What a patch by slices brings of a uniform mesh is not much more than what must come;
/// coarser bricks come as a whole.
TEST(MeshPatch, BringsBySlicesWhatHasNotBeenThere) {
  for (const Case& c : cases()) {
    if (c.name == "signs") continue;
    SCOPED_TRACE(c.name);
    const Plan earlier = plan_of(c.earlier, c.request), now = plan_of(c.now, c.request);
    ASSERT_TRUE(earlier && now);
    const auto by_bricks = patch_between(earlier, now);
    const auto by_slices = patch_between(earlier, now, PatchDetail::kSlices);
    ASSERT_TRUE(by_bricks && by_slices);
    const Shapes before = shapes_of(mesh_of(*earlier));
    std::uint64_t changed = 0;
    for (const auto& shape : shapes_of(mesh_of(*now)))
      changed += before.contains(shape) ? 0 : 1;
    const std::uint64_t tets = now->header().tet_count;
    const std::uint64_t by_slice = tets - kept_tets(*by_slices);
    const std::uint64_t by_brick = tets - kept_tets(*by_bricks);
    EXPECT_GE(by_slice, changed);
    EXPECT_LE(by_slice, by_brick);
    if (c.request.levels == 0) {
      EXPECT_LE(by_slice - changed, (by_brick - changed) / 2);
    }
  }
}

TEST(MeshPatch, KeepsAllButWhatIsNearTheChange) {
  const Plan earlier = plan_of(dented_ball(0), {}), now = plan_of(dented_ball(5), {});
  const auto patch = patch_between(earlier, now);
  ASSERT_TRUE(patch);
  EXPECT_GT(kept_tets(*patch), now->header().tet_count / 2);
  EXPECT_LT(kept_tets(*patch), now->header().tet_count);
}

TEST(MeshPatch, KeepsEverythingWhereNothingChanged) {
  const Plan plan = plan_of(test::ball(20), {});
  const auto patch = patch_between(plan, plan);
  ASSERT_TRUE(patch);
  EXPECT_EQ(patch->patch_count(), 0U);
  EXPECT_EQ(kept_tets(*patch), plan->header().tet_count);
}

TEST(MeshPatch, IsTheSameWhateverThePlansKept) {
  MeshLimits nothing_kept;
  nothing_kept.kept_geometry_bytes = 0;
  const Volume ball = dented_ball(0), dented = dented_ball(5);
  for (const PatchDetail detail : kDetails) {
    const auto one = patch_between(plan_of(ball, {}), plan_of(dented, {}), detail);
    const auto other = patch_between(plan_of(ball, {}, nothing_kept),
                                     plan_of(dented, {}, nothing_kept), detail);
    ASSERT_TRUE(one && other);
    EXPECT_EQ(one->kept().vertices, other->kept().vertices);
    EXPECT_EQ(one->kept().tets, other->kept().tets);
    EXPECT_EQ(one->patch_count(), other->patch_count());
  }
}

TEST(MeshPatch, KeepsNothingOfAMeshByOtherRules) {
  MeshRequest other;
  other.preset = Preset::kMinAngle;
  const Volume ball = test::ball(12);
  EXPECT_EQ(patch_between(plan_of(ball, {}), plan_of(ball, other)), nullptr);
}

/// Then the lattice has the same places of the world elsewhere.
TEST(MeshPatch, KeepsNothingOfAGridThatWasMovedByWholeCellsOrMirrored) {
  MeshRequest request;
  request.origin = WorldPoint{-64, -64, -64};
  const Volume ball = dented_ball(5, {0, 30, 0});
  Volume moved = ball, mirrored = ball;
  moved.transform.translation = {0, 0, 8};
  mirrored.transform.linear[1][1] = -1;
  const Plan earlier = plan_of(ball, request);
  for (const Volume& volume : {moved, mirrored}) {
    const Plan now = plan_of(volume, request);
    ASSERT_TRUE(earlier && now);
    ASSERT_TRUE(can_splice(earlier->header(), now->header()));
    EXPECT_EQ(patch_between(earlier, now), nullptr);
  }
}

TEST(MeshPatch, KeepsBricksAsAWholeWhereItWouldBeTooManyRuns) {
  const Plan earlier = plan_of(dented_ball(0), {}), now = plan_of(dented_ball(5), {});
  const auto whole = patch_between(earlier, now, PatchDetail::kWhole);
  const auto by_slices = patch_between(earlier, now, PatchDetail::kSlices);
  ASSERT_TRUE(whole && by_slices);
  const auto runs = [](const MeshPatch& patch) {
    return patch.kept().vertices.size() + patch.kept().tets.size();
  };
  ASSERT_LT(runs(*whole), runs(*by_slices));
  const auto with_at_most = [&](std::size_t most) {
    return MeshPatch::between(as_bricks(earlier), as_bricks(now), PatchDetail::kSlices, most);
  };
  EXPECT_TRUE(with_at_most(runs(*by_slices))->kept().loose);
  const auto fewer = with_at_most(runs(*whole));
  ASSERT_TRUE(fewer);
  EXPECT_FALSE(fewer->kept().loose);
  EXPECT_EQ(fewer->kept().vertices, whole->kept().vertices);
  EXPECT_EQ(fewer->kept().tets, whole->kept().tets);
  EXPECT_EQ(with_at_most(runs(*whole) - 1), nullptr);
}

TEST(Splice, IsTheSameInTheMemoryOfAnotherMesh) {
  const Plan earlier = plan_of(dented_ball(0), {}), now = plan_of(dented_ball(5), {});
  const auto patch = patch_between(earlier, now);
  ASSERT_TRUE(patch);
  for (const int radius : {8, 36}) {
    SCOPED_TRACE(radius);
    TetMesh used = mesh_of(*plan_of(test::ball(radius), {}));
    const std::byte* const memory = used.tets.bytes().data();
    const bool is_enough = used.tets.size() >= 16 * now->header().tet_count;
    const TetMesh mesh = spliced(mesh_of(*earlier), *now, *patch, std::move(used));
    EXPECT_TRUE(same_bytes(mesh, mesh_of(*now)));
    EXPECT_EQ(is_enough, radius == 36);
    EXPECT_TRUE(!is_enough || mesh.tets.bytes().data() == memory);
  }
}

/// Random runs of `count` vertices, some of them left out; in the new mesh there are gaps of
/// up to `most_new` others.
std::vector<KeptRun> random_runs(std::uint64_t count,
                                 std::uint64_t most_new,
                                 std::mt19937& random) {
  std::vector<KeptRun> runs;
  std::uint64_t from = random() % 3, to = random() % (most_new + 1);
  while (from < count) {
    const std::uint64_t kept = std::min<std::uint64_t>(1 + random() % 700, count - from);
    runs.push_back({from, to, kept});
    from += kept + random() % 3;
    to += kept + random() % (most_new + 1);
  }
  return runs;
}

/// Number of vertex `id` after those runs, or nothing.
std::optional<std::uint64_t> moved(const std::vector<KeptRun>& runs, std::uint64_t id) {
  for (const KeptRun& run : runs) {
    if (run.from <= id && id < run.from + run.count) return id - run.from + run.to;
  }
  return std::nullopt;
}

/// A mesh of unspecified positions whose tets have ids of one run, of two, or of any.
template <class Index>
TetMesh with_ids_of(std::span<const KeptRun> runs,
                    std::uint64_t vertices,
                    std::uint64_t of_runs,
                    std::mt19937& random) {
  MeshHeader header;
  header.vertex_count = vertices;
  header.tet_count = 1500;  // more than are moved at a time
  header.index_type = sizeof(Index) == 8 ? IndexType::kUint64 : IndexType::kUint32;
  TetMesh mesh(header);
  const std::span ids(reinterpret_cast<Index*>(mesh.tets.bytes().data()), 4 * header.tet_count);
  const std::array<std::size_t, 2> two{random() % runs.size(), random() % runs.size()};
  for (Index& id : ids) {
    const std::size_t any = random() % runs.size();
    const KeptRun& run = runs[of_runs > two.size() ? any : two[random() % of_runs]];
    id = static_cast<Index>(run.from + random() % run.count);
  }
  return mesh;
}

template <class Index>
void expect_moved_ids() {
  std::mt19937 random(20071);
  for (const std::uint64_t vertices : {1U, 255U, 256U, 257U, 3000U}) {
    for (int turn = 0; turn < 50; ++turn) {
      SCOPED_TRACE(vertices);
      const std::vector<KeptRun> runs = random_runs(vertices, turn % 2 == 0 ? 0 : 5, random);
      if (runs.empty()) continue;
      const std::uint64_t of_runs = 1 + static_cast<std::uint64_t>(turn) % 3;
      const TetMesh mesh = with_ids_of<Index>(runs, vertices, of_runs, random);
      MeshHeader now = mesh.header;
      now.vertex_count = runs.back().to + runs.back().count;
      const auto result = splice_mesh(mesh, now, {runs, {{0, 0, now.tet_count}}});
      ASSERT_TRUE(result.ok()) << result.status();
      for (std::uint64_t i = 0; i < now.tet_count; ++i) {
        for (std::size_t c = 0; c < 4; ++c) {
          ASSERT_EQ(result->tet(i)[c], moved(runs, mesh.tet(i)[c])) << i;
        }
      }
    }
  }
}

TEST(Splice, MovesIdsAsOneAfterTheOtherWould) {
  expect_moved_ids<std::uint32_t>();
  expect_moved_ids<std::uint64_t>();
}

TEST(Splice, RefusesATetWithAVertexThatThereIsNot) {
  TetMesh mesh = mesh_of(*plan_of(test::ball(8), {}));
  const std::uint64_t vertices = mesh.header.vertex_count, tets = mesh.header.tet_count;
  reinterpret_cast<std::uint32_t*>(mesh.tets.bytes().data())[5] =
      static_cast<std::uint32_t>(vertices);
  EXPECT_TRUE(absl::IsInvalidArgument(
      splice_mesh(mesh, mesh.header, {{{0, 0, vertices}}, {{0, 0, tets}}}).status()));
}

TEST(Splice, RefusesATetWithAVertexBetweenTwoRuns) {
  MeshHeader header;
  header.vertex_count = 1000;
  header.tet_count = 100;
  TetMesh mesh(header);
  const std::span ids(reinterpret_cast<std::uint32_t*>(mesh.tets.bytes().data()), 400);
  std::ranges::fill(ids, 10);
  ids[77] = 990;
  const std::vector<KeptRun> runs{{0, 0, 100}, {102, 200, 5}, {900, 300, 100}};
  const auto outcome = [&] {
    return splice_mesh(mesh, header, {runs, {{0, 0, header.tet_count}}}).status().code();
  };
  EXPECT_EQ(outcome(), absl::StatusCode::kOk);
  for (const std::uint32_t id : {100U, 101U, 107U, 899U}) {
    ids[300] = id;
    EXPECT_EQ(outcome(), absl::StatusCode::kInvalidArgument) << id;
    ids[78] = id;  // in the block of both runs, too
    EXPECT_EQ(outcome(), absl::StatusCode::kInvalidArgument) << id;
    ids[300] = ids[78] = 104;
    EXPECT_EQ(outcome(), absl::StatusCode::kOk);
    ids[78] = 10;
  }
}

TEST(Splice, RefusesRunsThatDoNotFit) {
  const TetMesh mesh = mesh_of(*plan_of(test::ball(8), {}));
  const std::uint64_t vertices = mesh.header.vertex_count, tets = mesh.header.tet_count;
  const KeptRun all_vertices{0, 0, vertices}, all_tets{0, 0, tets};
  const auto outcome = [&](std::vector<KeptRun> kept_vertices, std::vector<KeptRun> kept_tets) {
    return splice_mesh(mesh, mesh.header, {std::move(kept_vertices), std::move(kept_tets)})
        .status()
        .code();
  };
  constexpr auto kRefused = absl::StatusCode::kInvalidArgument;
  const auto run = [](std::uint64_t from, std::uint64_t to, std::uint64_t count) {
    return KeptRun{from, to, count};
  };
  EXPECT_EQ(outcome({all_vertices}, {all_tets}), absl::StatusCode::kOk);
  EXPECT_EQ(outcome({run(0, 0, vertices + 1)}, {}), kRefused);
  EXPECT_EQ(outcome({run(1, 0, vertices)}, {}), kRefused);
  EXPECT_EQ(outcome({run(0, 1, vertices)}, {}), kRefused);
  EXPECT_EQ(outcome({run(0, ~std::uint64_t{0}, 2)}, {}), kRefused);
  EXPECT_EQ(outcome({run(0, 0, 10), run(5, 20, 10)}, {}), kRefused);
  EXPECT_EQ(outcome({all_vertices}, {all_tets, run(0, 0, 1)}), kRefused);
  EXPECT_EQ(outcome({run(0, 0, vertices / 2)}, {all_tets}), kRefused);
}

}  // namespace
}  // namespace tet::mesh_patch_test
