// Meshes that a server sends, taken chunk by chunk.
#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "client/library/chunk_supply.h"
#include "tests/client/cutting_proxy.h"
#include "tests/core/plan/meshing.h"
#include "tests/server/service_fixture.h"
#include "tests/support/unused_port.h"

namespace tet::test {
namespace {

constexpr std::uint64_t kAnyNumber = ~std::uint64_t{0};

class ChunkStreamTest : public ServiceTest {
 protected:
  ChunkStreamTest() {
    config_.drain_seconds = 0;
    start();
  }

  std::unique_ptr<ChunkSupply> chunks_of(const v1::MeshRequest& request,
                                         v1::Encoding encoding = v1::ENCODING_PLAIN) {
    return client_->stream_chunks(request, {}, never_, {.encoding = encoding, .used = {}});
  }

  v1::MeshRequest ball_with_field(int radius) {
    v1::MeshRequest request = uniform_ball(radius);
    request.add_fields()->set_name("distance");
    return request;
  }
};

/// What a solver would do: a mesh from a header and chunks, each of which follows the one
/// before.
class Assembly {
 public:
  explicit Assembly(const MeshHeader& header) : mesh_(header) {}

  void add(const ChunkView& chunk) {
    EXPECT_EQ(chunk.index, count_++);
    EXPECT_EQ(chunk.place.first_vertex, vertices_);
    EXPECT_EQ(chunk.place.first_tet, tets_);
    vertices_ += chunk.place.vertex_count;
    tets_ += chunk.place.tet_count;
    const ChunkColumns to = mesh_.columns_of(chunk.place);
    copy(chunk.columns.positions, to.positions);
    copy(chunk.columns.tets, to.tets);
    copy(chunk.columns.regions, to.regions);
    copy(chunk.columns.fields, to.fields);
  }

  void expect_whole() const {
    EXPECT_EQ(count_, mesh_.header.chunk_count);
    EXPECT_EQ(vertices_, mesh_.header.vertex_count);
    EXPECT_EQ(tets_, mesh_.header.tet_count);
  }

  const TetMesh& mesh() const { return mesh_; }

 private:
  static void copy(std::span<const std::byte> from, std::span<std::byte> to) {
    ASSERT_EQ(from.size(), to.size());
    std::copy(from.begin(), from.end(), to.begin());
  }

  TetMesh mesh_;
  std::uint64_t count_ = 0, vertices_ = 0, tets_ = 0;
};

Assembly assembled(ChunkSupply& source) {
  const auto header = source.header();
  EXPECT_TRUE(header.ok()) << header.status();
  Assembly assembly(**header);
  for (auto chunk = source.next();; chunk = source.next()) {
    EXPECT_TRUE(chunk.ok()) << chunk.status();
    if (!chunk.ok() || *chunk == nullptr) break;
    assembly.add(**chunk);
  }
  assembly.expect_whole();
  return assembly;
}

void expect_same(const TetMesh& a, const TetMesh& b) {
  EXPECT_TRUE(test::same_bytes(a, b));
  EXPECT_TRUE(std::ranges::equal(a.fields.bytes(), b.fields.bytes()));
}

TEST_F(ChunkStreamTest, AreTogetherTheMeshWhateverTheEncoding) {
  for (const v1::MeshRequest& request : {uniform_ball(16), both_sides_of_ball(16, 2)}) {
    const auto whole = client_->stream_mesh(request, {}, never_);
    ASSERT_TRUE(whole.ok()) << whole.status();
    for (const auto encoding :
         {v1::ENCODING_PLAIN, v1::ENCODING_PACKED, v1::ENCODING_COMPACT}) {
      const auto source = chunks_of(request, encoding);
      expect_same(assembled(*source).mesh(), whole->mesh);
      EXPECT_EQ(source->mesh_id(), whole->mesh_id);
      ASSERT_TRUE(source->facts().quality);
      EXPECT_EQ(source->facts().quality->histogram, whole->quality.histogram);
      EXPECT_TRUE(source->facts().boundary == whole->boundary);
    }
  }
}

TEST_F(ChunkStreamTest, HaveTheValuesOfFields) {
  const v1::MeshRequest request = ball_with_field(16);
  const auto whole = client_->stream_mesh(request, {}, never_);
  ASSERT_TRUE(whole.ok()) << whole.status();
  EXPECT_GT(whole->mesh.fields.size(), 0U);
  for (const auto encoding : {v1::ENCODING_PLAIN, v1::ENCODING_PACKED}) {
    expect_same(assembled(*chunks_of(request, encoding)).mesh(), whole->mesh);
  }
}

TEST_F(ChunkStreamTest, AreMadeAsTheyAreTaken) {
  const auto held = chunks_of(uniform_ball(48));  // 75 MB: more than can be on its way
  const auto header = held->header();
  ASSERT_TRUE(header.ok()) << header.status();
  const auto count = static_cast<std::int64_t>((*header)->chunk_count);
  for (int i = 0; i < 3; ++i) {
    const auto chunk = held->next();
    ASSERT_TRUE(chunk.ok() && *chunk != nullptr) << chunk.status();
  }
  // While another mesh is made from its beginning to its end this one does not get further than
  // its buffers.
  const auto other = client_->stream_mesh(uniform_ball(30), {}, never_);
  ASSERT_TRUE(other.ok()) << other.status();
  const auto others = static_cast<std::int64_t>(other->mesh.header.chunk_count);
  EXPECT_LT(activity().chunks_made - others, count / 2);
  EXPECT_EQ(activity().meshes, 1);
}

TEST_F(ChunkStreamTest, GiveTheServersPlaceBackWhenTheyAreGivenUp) {
  auto source = chunks_of(uniform_ball(48));
  const auto chunk = source->next();
  ASSERT_TRUE(chunk.ok() && *chunk != nullptr) << chunk.status();
  EXPECT_EQ(activity().meshes, 1);
  source.reset();
  EXPECT_TRUE(work_stops());
}

TEST_F(ChunkStreamTest, GoOnWhereAConnectionBroke) {
  const v1::MeshRequest ball = uniform_ball(28);
  const auto whole = client_->stream_mesh(ball, {}, never_);
  ASSERT_TRUE(whole.ok()) << whole.status();
  // Each lets some chunks through, and not half of the mesh.
  using Cut = std::pair<v1::Encoding, std::uint64_t>;
  for (const auto& cut : {Cut{v1::ENCODING_PLAIN, 7'000'000}, Cut{v1::ENCODING_PACKED, 300'000},
                          Cut{v1::ENCODING_COMPACT, 50'000}}) {
    const auto encoding = cut.first;
    const std::uint64_t down = cut.second;
    CuttingProxy proxy(server_->port(), kAnyNumber, down);
    const auto client =
        MeshClient::connect(proxy.address(), {.attempts = 6, .first_backoff_ms = 10});
    const auto source =
        client->stream_chunks(ball, {}, never_, {.encoding = encoding, .used = {}});
    expect_same(assembled(*source).mesh(), whole->mesh);
    EXPECT_GT(proxy.cuts(), 0);
  }
}

TEST_F(ChunkStreamTest, GoOnWhenTheServerIsBack) {
  const UnusedPort port;
  config_.listen = port.address();
  restart();
  const v1::MeshRequest ball = uniform_ball(48);
  const auto source = chunks_of(ball);
  const auto header = source->header();
  ASSERT_TRUE(header.ok()) << header.status();
  Assembly assembly(**header);
  auto chunk = source->next();
  ASSERT_TRUE(chunk.ok() && *chunk != nullptr) << chunk.status();
  assembly.add(**chunk);

  const auto client = std::exchange(client_, nullptr);  // which the source's connection is of
  restart();
  for (chunk = source->next(); chunk.ok() && *chunk != nullptr; chunk = source->next()) {
    assembly.add(**chunk);
  }
  ASSERT_TRUE(chunk.ok()) << chunk.status();
  assembly.expect_whole();
  const auto whole = client_->stream_mesh(ball, {}, never_);
  ASSERT_TRUE(whole.ok()) << whole.status();
  expect_same(assembly.mesh(), whole->mesh);
}

TEST_F(ChunkStreamTest, TellAFailureAgain) {
  v1::MeshRequest request;
  request.set_name("grids/" + std::string(64, '0'));
  const auto source = chunks_of(request);
  EXPECT_EQ(source->header().status().code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(source->next().status().code(), absl::StatusCode::kNotFound);
}

}  // namespace
}  // namespace tet::test
