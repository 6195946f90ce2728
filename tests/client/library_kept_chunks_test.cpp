// Chunks that a reader keeps.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "client/library/reused_chunk.h"
#include "tests/client/library_fixture.h"

namespace tetstream {
namespace {

using test::BallSamples;
using KeptChunksOfAServer = test::LibraryOnAServer;

/// Keeps every other chunk to the end, and after the stream's own; what was kept is the mesh's.
void expect_kept_are_of(const Mesh& whole, MeshStream from) {
  std::vector<std::pair<Chunk, std::shared_ptr<const void>>> kept;
  {
    MeshStream stream = std::move(from);
    EXPECT_EQ(stream.keep_chunk(), nullptr);
    while (const Chunk* const chunk = stream.next()) {
      if (chunk->index % 2 == 0) kept.emplace_back(*chunk, stream.keep_chunk());
    }
    const auto end = stream.finish();
    EXPECT_TRUE(end.ok()) << end.status().to_string();
  }
  ASSERT_GT(kept.size(), 2U);
  for (const auto& [chunk, memory] : kept) {
    ASSERT_NE(memory, nullptr);
    const auto tets = whole.columns().tets32.subspan(4 * chunk.first_tet, 4 * chunk.tet_count);
    const auto points =
        whole.columns().points32.subspan(3 * chunk.first_vertex, 3 * chunk.vertex_count);
    EXPECT_TRUE(std::ranges::equal(chunk.columns.tets32, tets));
    EXPECT_TRUE(std::ranges::equal(chunk.columns.points32, points));
  }
}

TEST(KeptChunks, OfThisProcessStayAsTheyAre) {
  const Volume ball = BallSamples(20).volume();
  const Request request{.levels = 0};
  const Mesh whole = mesh(ball, request).value();
  expect_kept_are_of(whole, stream(ball, request, {.threads = 1}));
  expect_kept_are_of(whole, stream(ball, request, {.threads = 2}));
}

TEST_F(KeptChunksOfAServer, StayAsTheyAre) {
  const Volume ball = BallSamples(20).volume();
  const Request request{.levels = 0};
  const Mesh whole = mesh(ball, request).value();
  const StoredVolume stored = client().upload(ball).value();
  for (const Encoding encoding : {Encoding::kPlain, Encoding::kPacked, Encoding::kCompact}) {
    StreamOptions options;
    options.encoding = encoding;
    expect_kept_are_of(whole, client().stream(stored, request, options));
  }
  expect_kept_are_of(whole, client().stream(stored, request, {}, ChunkRange{.first = 0}));
}

/// Who reads one chunk after another makes the stream take memory twice, and not once a chunk.
TEST(KeptChunks, GiveTheirMemoryBackWhenNobodyReadsThem) {
  const tet::MeshHeader header;
  tet::ReusedChunk memory;
  const tet::TetMesh* const first = &memory.make(header);
  EXPECT_EQ(&memory.make(header), first);

  auto kept = memory.kept();
  const tet::TetMesh* const second = &memory.make(header);
  EXPECT_NE(second, first);
  for (int i = 0; i < 4; ++i) {
    kept = memory.kept();  // the one before is let go of
    const tet::TetMesh* const next = &memory.make(header);
    EXPECT_TRUE(next == first || next == second);
    EXPECT_NE(next, kept.get());
  }
}

TEST(KeptChunks, KeepTheirMemoryHoweverManyThereAre) {
  tet::ReusedChunk memory;
  std::set<std::shared_ptr<const tet::TetMesh>> kept;
  for (std::size_t i = 1; i <= 100; ++i) {
    memory.make({});
    kept.insert(memory.kept());
    EXPECT_EQ(kept.size(), i);
  }
}

}  // namespace
}  // namespace tetstream
