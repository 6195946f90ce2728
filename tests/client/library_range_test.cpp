// Some of a mesh's chunks, here and on a server.
#include <cstdint>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "tests/client/library_fixture.h"

namespace tetstream {
namespace {

using test::BallSamples;
using RangeOnAServer = test::LibraryOnAServer;

/// The ids of a range's tets, and where they are in the mesh.
struct Range {
  std::uint64_t first_tet = 0, chunks = 0;
  std::vector<std::uint32_t> tets;
};

Range read(MeshStream stream) {
  Range range;
  while (const Chunk* const chunk = stream.next()) {
    if (range.chunks++ == 0) range.first_tet = chunk->first_tet;
    range.tets.insert(range.tets.end(), chunk->columns.tets32.begin(),
                      chunk->columns.tets32.end());
  }
  const auto end = stream.finish();
  EXPECT_TRUE(end.ok()) << end.status().to_string();
  return range;
}

/// Every cut of the mesh into two ranges has all of it.
template <class Open>
void expect_ranges_are(const Mesh& whole, const Open& open) {
  const std::uint64_t count = whole.header().chunk_count;
  ASSERT_GT(count, 3U);
  for (const std::uint64_t cut : {std::uint64_t{0}, std::uint64_t{1}, count - 1, count}) {
    const Range before = read(open({0, cut})), after = read(open({cut, {}}));
    EXPECT_EQ(before.chunks, cut);
    EXPECT_EQ(after.chunks, count - cut);
    if (after.chunks > 0) {
      EXPECT_EQ(after.first_tet, before.tets.size() / 4);
    }
    std::vector<std::uint32_t> tets = before.tets;
    tets.insert(tets.end(), after.tets.begin(), after.tets.end());
    EXPECT_TRUE(std::ranges::equal(tets, whole.columns().tets32));
  }
}

TEST(LibraryRange, IsMadeHere) {
  const Volume ball = BallSamples(20).volume();
  const Request request{.levels = 0};
  expect_ranges_are(mesh(ball, request).value(),
                    [&](ChunkRange chunks) { return stream(ball, request, {}, chunks); });
  const std::uint64_t count = estimate(ball, request)->chunk_count;
  const Status beyond = stream(ball, request, {}, {count + 1, {}}).header().status();
  EXPECT_EQ(beyond.code(), StatusCode::kOutOfRange);
  EXPECT_EQ(beyond.reason(), "CHUNK_RANGE");
}

TEST_F(RangeOnAServer, IsSent) {
  const Volume ball = BallSamples(20).volume();
  const Request request{.levels = 0};
  const StoredVolume stored = client().upload(ball).value();
  const Mesh whole = mesh(ball, request).value();
  expect_ranges_are(
      whole, [&](ChunkRange chunks) { return client().stream(stored, request, {}, chunks); });
  EXPECT_EQ(client().estimate(stored, request)->chunk_count, whole.header().chunk_count);
  const auto beyond = client().stream(stored, request, {}, {1000, {}}).header();
  EXPECT_EQ(beyond.status().code(), StatusCode::kOutOfRange);
}

}  // namespace
}  // namespace tetstream
