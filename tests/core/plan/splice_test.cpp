#include "core/mesh/stable/splice.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/core/plan/mesh_patches.h"
#include "tests/support/solids.h"

namespace tet::mesh_patch_test {
namespace {

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
