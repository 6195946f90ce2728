// Events of chunks that come through the socket of shared memory: the same messages, and
// clients that do not do what they should.
#include <array>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/core/plan/meshing.h"
#include "tests/server/reason_of.h"
#include "tests/server/shared_memory_fixture.h"

namespace tet::test {
namespace {

/// A client that wants events beside the stream, and may do as it likes.
class BesideClient : public WilfulClient {
 public:
  using WilfulClient::WilfulClient;

  void begin(v1::StreamMeshRequest request) {
    request.set_shared_memory_events(true);
    WilfulClient::begin(request, token());
  }
  /// The next event beside the stream; nothing where it is said to be in the stream.
  std::optional<v1::MeshEvent> next() const {
    std::array<std::byte, kMostSideEventBytes> bytes{};
    std::size_t size = 0;
    EXPECT_EQ(await_any_packet(side(), bytes, size, kGenerousEnd), Packet::kTaken);
    if (size == 1 && bytes[0] == kNextIsInStream[0]) return std::nullopt;
    v1::MeshEvent event;
    EXPECT_TRUE(event.ParseFromArray(bytes.data(), static_cast<int>(size)));
    return event;
  }
};

class ChunksBeside : public SharedMemoryTest {};

TEST_F(ChunksBeside, AreTheMessagesOfTheStream) {
  start();
  const v1::StreamMeshRequest request = stream_of(uniform_ball(40));
  WilfulClient plain(socket_);
  plain.begin(request, plain.token());
  ASSERT_TRUE(plain.has_ring());
  EXPECT_FALSE(plain.header().shared_memory().events());
  std::vector<std::string> in_stream, beside;
  while (plain.read_chunk()) {
    in_stream.push_back(plain.chunk().SerializeAsString());
    plain.say(in_stream.size() - 1);
  }
  EXPECT_TRUE(plain.finish().ok());

  BesideClient client(socket_);
  client.begin(request);
  ASSERT_TRUE(client.has_ring());
  EXPECT_TRUE(client.header().shared_memory().events());
  client.take_memory();
  while (const auto event = client.next()) {
    beside.push_back(event->chunk().SerializeAsString());
    client.say(beside.size() - 1);
  }
  EXPECT_GT(beside.size(), kRingBlocks);
  EXPECT_EQ(beside, in_stream);
  EXPECT_FALSE(client.read_chunk());
  EXPECT_TRUE(client.finish().ok());
  EXPECT_TRUE(eventually([&] { return engine().send_budget.used_bytes() == kept_bytes(); }));
}

TEST_F(ChunksBeside, AnAnswerStandsForAllBefore) {
  start();
  BesideClient client(socket_);
  client.begin(stream_of(uniform_ball(40)));
  ASSERT_TRUE(client.has_ring());
  client.take_memory();
  std::uint64_t told = 0;
  for (bool more = true; more;) {
    const std::uint64_t before = told;
    // There is room for no more of them.
    while (told < before + kRingBlocks && (more = client.next().has_value())) ++told;
    if (told > before) client.say(told - 1);
  }
  EXPECT_GT(told, 2 * kRingBlocks);
  EXPECT_TRUE(client.finish().ok());
}

TEST_F(ChunksBeside, AnswersThatCannotBeEndTheStream) {
  start();
  const v1::StreamMeshRequest request = stream_of(uniform_ball(40));
  // Twice, back, ahead of what it was told of, and of no chunk at all.
  for (const std::vector<std::uint64_t>& said : {std::vector<std::uint64_t>{2, 2},
                                                 {2, 1},
                                                 {2, 2 + 2 * kRingBlocks},
                                                 {~std::uint64_t{0}}}) {
    BesideClient client(socket_), patient(socket_);
    client.begin(request);
    patient.begin(request);
    ASSERT_TRUE(client.has_ring() && patient.has_ring());
    client.take_memory();
    patient.take_memory();
    for (int chunk = 0; chunk < 3; ++chunk) ASSERT_TRUE(client.next().has_value());
    for (const std::uint64_t index : said) client.say(index);
    EXPECT_EQ(reason_of(client.finish()), "tetstream/MESSAGE_ORDER");
    for (std::uint64_t index = 0; patient.next();) patient.say(index++);
    EXPECT_TRUE(patient.finish().ok());
  }
}

TEST_F(ChunksBeside, WhoeverReadsNothingIsStalled) {
  start();
  const v1::StreamMeshRequest request = stream_of(uniform_ball(40));
  const std::string reason = reason_when_stalled([&] {
    const auto all_blocks = activity().chunks_made + static_cast<std::int64_t>(kRingBlocks);
    BesideClient client(socket_);
    client.begin(request);
    EXPECT_TRUE(client.has_ring());
    EXPECT_TRUE(eventually([&] { return activity().chunks_made >= all_blocks; }));
    const PassingTime passing(*server_, config_.stall_seconds);
    return client.finish();
  });
  EXPECT_EQ(reason, "tetstream/CLIENT_STALLED");
  EXPECT_TRUE(work_stops());
  EXPECT_EQ(kept_bytes(), 0U);
}

TEST_F(ChunksBeside, EndWithoutATrailerWhereNotAllAreAskedFor) {
  start();
  v1::StreamMeshRequest request = stream_of(uniform_ball(40), 1);
  request.set_end_chunk(4);
  BesideClient client(socket_);
  client.begin(request);
  ASSERT_TRUE(client.has_ring());
  client.take_memory();
  for (std::uint64_t index = 1; index < 4; ++index) {
    const auto event = client.next();
    ASSERT_TRUE(event.has_value());
    EXPECT_EQ(event->chunk().index(), static_cast<std::int64_t>(index));
  }
  EXPECT_FALSE(client.next().has_value());
  client.say(3);
  EXPECT_TRUE(client.finish().ok());
  client.begin(request);  // the connection serves the next
  EXPECT_TRUE(client.has_ring());
}

// Many values at each vertex, and many vertices: some bricks are more than a chunk.
TEST_F(ChunksBeside, OneThatFitsIntoNoBlockComesInTheStream) {
  start();
  const std::string values = mesh_of(solid_file("fields", 0.1)).name();
  v1::MeshRequest mesh = mesh_of(solid_file("random-signs", 0.1));
  mesh.set_preset(v1::PRESET_BOTH_SIDES);
  mesh.set_faces(true);
  mesh.set_coordinate_type(v1::COORDINATE_TYPE_FLOAT64);
  mesh.set_levels(0);
  for (int i = 0; i < 16; ++i) {
    v1::Field& field = *mesh.add_fields();
    field.set_name(std::to_string(i));
    field.set_grid(values);
    field.set_grid_name("velocity");
  }
  const StreamedMesh by_port = received(*client_, mesh);
  const StreamedMesh shared = received(*local(), mesh);
  EXPECT_TRUE(shared.shared_memory);
  EXPECT_TRUE(same_bytes(by_port.mesh, shared.mesh));

  v1::StreamMeshRequest request = stream_of(mesh);
  std::vector<std::uint64_t> in_stream;
  const auto take_all = [&](std::uint64_t chunks) {
    in_stream.clear();
    BesideClient client(socket_);
    client.begin(request);
    ASSERT_TRUE(client.has_ring());
    client.take_memory();
    for (std::uint64_t index = 0; index < chunks; ++index) {
      if (!client.next()) {
        ASSERT_TRUE(client.read_chunk());
        EXPECT_FALSE(client.chunk().has_shared_offset());
        EXPECT_EQ(client.chunk().index(), static_cast<std::int64_t>(index));
        in_stream.push_back(index);
      }
      client.say(index);
    }
    EXPECT_FALSE(client.next().has_value());
    EXPECT_TRUE(client.finish().ok());
  };
  take_all(shared.mesh.header.chunk_count);
  ASSERT_FALSE(in_stream.empty() || HasFailure());
  EXPECT_LT(in_stream.size(), shared.mesh.header.chunk_count);
  // And as the last one that is asked for.
  const std::uint64_t last = in_stream.front();
  request.set_end_chunk(static_cast<std::int64_t>(last + 1));
  take_all(last + 1);
  EXPECT_EQ(in_stream, std::vector{last});
}

TEST_F(ChunksBeside, AreNoneWhereThereIsNoChunk) {
  start();
  const v1::MeshRequest mesh = uniform_ball(12);
  const StreamedMesh whole = received(*client_, mesh);
  BesideClient client(socket_);
  client.begin(stream_of(mesh, static_cast<std::int64_t>(whole.mesh.header.chunk_count)));
  ASSERT_TRUE(client.has_ring());
  EXPECT_FALSE(client.header().shared_memory().events());
  EXPECT_FALSE(client.read_chunk());
  EXPECT_TRUE(client.finish().ok());
}

TEST_F(ChunksBeside, AClientThatRestsIsNotInTheWayOfItself) {
  start();
  const auto client = local();
  const v1::MeshRequest request = uniform_ball(20);
  EXPECT_TRUE(received(*client, request).shared_memory);
  std::vector<Descriptor> held;
  for (std::size_t i = 0; i < SharedMemoryPort::kMostUnclaimedOfUser; ++i) {
    held.push_back(connect_for_packets(socket_ + kSideSocketEnding));
    std::array<std::byte, SideConnection::kTokenBytes> token{};
    Descriptor none;
    ASSERT_TRUE(await_packet(held.back(), token, kGenerousEnd, none)) << i;
  }
  // At once: a connection that nobody claims for a minute is ended, and leaves room.
  EXPECT_FALSE(received(*local(), request).shared_memory);
  // It gives its connection back, and has it again, whoever waits for a stream.
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(received(*client, request).shared_memory);
}

}  // namespace
}  // namespace tet::test
