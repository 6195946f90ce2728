// Chunks in shared memory: the same bytes, and clients that do not do what they should.
#include <array>
#include <atomic>
#include <cerrno>
#include <filesystem>
#include <optional>
#include <set>
#include <sys/mman.h>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/posix/socket_file.h"
#include "server/shared_memory/shared_memory_port.h"
#include "tests/core/plan/meshing.h"
#include "tests/server/reason_of.h"
#include "tests/server/shared_memory_fixture.h"

namespace tet::test {
namespace {

using testing::HasSubstr;

TEST_F(SharedMemoryTest, BringsTheSameBytesForAnyThreads) {
  for (const std::uint64_t threads : {1u, 2u, 5u}) {
    config_.threads = threads;
    restart();
    v1::MeshRequest graded = mesh_of(solid_file("torus", 0.02));
    graded.set_levels(24);
    v1::MeshRequest faces = uniform_ball(20);
    faces.set_faces(true);
    for (const v1::MeshRequest& request :
         {graded, faces, uniform_ball(30), both_sides_of_ball(12, 1.5)}) {
      const StreamedMesh by_port = received(*client_, request);
      const StreamedMesh shared = received(*local(), request);
      EXPECT_FALSE(by_port.shared_memory);
      EXPECT_TRUE(shared.shared_memory);
      EXPECT_TRUE(same_bytes(by_port.mesh, shared.mesh)) << threads;
      EXPECT_EQ(by_port.mesh_id, shared.mesh_id);
    }
    EXPECT_EQ(shared_streams(), 4);
    EXPECT_TRUE(work_stops());
    EXPECT_TRUE(eventually([&] { return engine().send_budget.used_bytes() == kept_bytes(); }));
  }
}

TEST_F(SharedMemoryTest, GoesOnWhereAServerEnded) {
  start();
  const v1::MeshRequest request = uniform_ball(40);
  const StreamedMesh whole = received(*client_, request);
  const auto client = local();
  bool restarted = false;
  const ClientProgress progress{{}, {}, [&](std::uint64_t done, std::uint64_t) {
                                  if (done > 0 && !std::exchange(restarted, true)) restart();
                                }};
  const auto mesh = client->stream_mesh(request, progress, never_);
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_TRUE(restarted);
  EXPECT_TRUE(mesh->shared_memory);
  EXPECT_TRUE(same_bytes(whole.mesh, mesh->mesh));
}

// What is left beside the stream when a call is stopped is not taken for missing.
TEST_F(SharedMemoryTest, ACallThatIsStoppedAnywhereSaysThatItWas) {
  start();
  const v1::MeshRequest request = uniform_ball(20);
  const auto client = local();
  int stopped = 0;
  for (int looks = 0; looks < 120; ++looks) {
    std::atomic<int> left{looks};
    const Cancellation stops(Cancellation::Clock::time_point::max(),
                             [&] { return left.fetch_sub(1) <= 0; });
    const auto mesh = client->stream_mesh(request, {}, stops);
    if (mesh.ok()) continue;
    ++stopped;
    EXPECT_EQ(mesh.status().code(), absl::StatusCode::kCancelled)
        << looks << ": " << mesh.status();
  }
  EXPECT_GT(stopped, 0);
}

TEST_F(SharedMemoryTest, BringsAnyRangeAndPatches) {
  start();
  const v1::MeshRequest request = uniform_ball(30);
  const StreamedMesh first = received(*client_, request);
  v1::MeshRequest changed = request;
  changed.set_iso(0.001);
  const StreamedMesh whole = received(*client_, changed);
  const auto updated = local()->update_mesh(changed, first, {}, never_);
  ASSERT_TRUE(updated.ok()) << updated.status();
  EXPECT_TRUE(same_bytes(whole.mesh, updated->mesh));
  EXPECT_EQ(tets_by_chunks(*local(), request), first.mesh.header.tet_count);
}

TEST_F(SharedMemoryTest, IsOrdinaryWhereItIsNotWantedOrNotOffered) {
  start();
  const v1::MeshRequest request = uniform_ball(20);
  ChannelOptions without;
  without.shared_memory = false;
  const auto client = MeshClient::connect("unix:" + socket_, without);
  ASSERT_TRUE(client.ok());
  EXPECT_FALSE(received(**client, request).shared_memory);
  for (const v1::Encoding encoding : {v1::ENCODING_PACKED, v1::ENCODING_COMPACT}) {
    StreamOptions options;
    options.encoding = encoding;
    const auto mesh = local()->stream_mesh(request, {}, never_, std::move(options));
    ASSERT_TRUE(mesh.ok()) << mesh.status();
    EXPECT_FALSE(mesh->shared_memory);
  }
  config_.shared_memory = "off";
  restart();
  EXPECT_FALSE(std::filesystem::exists(socket_ + kSideSocketEnding));
  EXPECT_FALSE(received(*local(), request).shared_memory);
  EXPECT_EQ(shared_streams(), 0);
}

// What is improved is measured by the ids in its chunks, which some clients could change.
TEST_F(SharedMemoryTest, IsOrdinaryWhereTheMeshIsImproved) {
  start();
  v1::MeshRequest request = uniform_ball(12);
  request.set_improve(true);
  const StreamedMesh by_port = received(*client_, request);
  const StreamedMesh by_file = received(*local(), request);
  ASSERT_TRUE(by_port.improvement.has_value());
  EXPECT_FALSE(by_file.shared_memory);
  EXPECT_TRUE(same_bytes(by_port.mesh, by_file.mesh));
  EXPECT_EQ(shared_streams(), 0);
}

TEST_F(SharedMemoryTest, IsOrdinaryWhereThereIsNoRoomForIt) {
  config_.send_bytes = std::uint64_t{2} << 20;  // less than a ring
  start();
  const v1::MeshRequest request = uniform_ball(30);
  const StreamedMesh by_port = received(*client_, request);
  const StreamedMesh by_file = received(*local(), request);
  EXPECT_FALSE(by_file.shared_memory);
  EXPECT_TRUE(same_bytes(by_port.mesh, by_file.mesh));
}

TEST_F(SharedMemoryTest, NobodyElseWritesItOrMakesItShorter) {
  start();
  WilfulClient client(socket_);
  client.begin(stream_of(uniform_ball(30)), client.token());
  ASSERT_TRUE(client.has_ring());
  const Descriptor memory = client.take_memory();
  ASSERT_TRUE(memory.is_open());
  EXPECT_EQ(::mmap(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_SHARED, memory.number(), 0),
            MAP_FAILED);
  EXPECT_NE(::ftruncate(memory.number(), 0), 0);
  EXPECT_EQ(::pwrite(memory.number(), "x", 1, 0), -1);
  const Descriptor again =
      open_descriptor("/proc/self/fd/" + std::to_string(memory.number()), O_RDWR);
  EXPECT_EQ(::pwrite(again.number(), "x", 1, 0), -1);
}

TEST_F(SharedMemoryTest, HasABlockForEachChunkThatIsNotAcknowledged) {
  start();
  WilfulClient client(socket_);
  client.begin(stream_of(uniform_ball(40)), client.token());
  ASSERT_TRUE(client.has_ring());
  std::set<std::int64_t> offsets;
  for (std::uint64_t i = 0; i < kRingBlocks; ++i) {
    ASSERT_TRUE(client.read_chunk());
    offsets.insert(client.chunk().shared_offset());
  }
  EXPECT_EQ(offsets.size(), kRingBlocks);
  // The first that is free again is used again.
  std::uint64_t index = 0;
  client.say(index++);
  ASSERT_TRUE(client.read_chunk());
  EXPECT_EQ(client.chunk().shared_offset(), 0);
  for (; index <= kRingBlocks; ++index) client.say(index);
  while (client.read_chunk()) client.say(index++);
  EXPECT_TRUE(client.finish().ok());
}

TEST_F(SharedMemoryTest, WhoeverAcknowledgesNothingIsStalled) {
  start();
  const v1::MeshRequest request = uniform_ball(40);
  const std::string reason = reason_when_stalled([&] {
    WilfulClient client(socket_);
    client.begin(stream_of(request), client.token());
    EXPECT_TRUE(client.has_ring());
    for (std::uint64_t i = 0; i < kRingBlocks; ++i) EXPECT_TRUE(client.read_chunk());
    const PassingTime passing(*server_, config_.stall_seconds);
    EXPECT_FALSE(client.read_chunk()) << "there is no block for it";
    return client.finish();
  });
  EXPECT_EQ(reason, "tetstream/CLIENT_STALLED");
  EXPECT_TRUE(received(*local(), request).shared_memory);
  EXPECT_TRUE(work_stops());
}

TEST_F(SharedMemoryTest, AcknowledgementsOutOfOrderEndTheirStreamAlone) {
  start();
  const v1::MeshRequest request = uniform_ball(40);
  // Twice, ahead of what it was told of, and of no chunk at all.
  for (const std::vector<std::uint64_t>& said :
       {std::vector<std::uint64_t>{0, 0}, {1}, {0, 5}, {~std::uint64_t{0}}}) {
    WilfulClient client(socket_), patient(socket_);
    client.begin(stream_of(request), client.token());
    patient.begin(stream_of(request), patient.token());
    ASSERT_TRUE(client.has_ring() && patient.has_ring());
    ASSERT_TRUE(client.read_chunk());
    for (const std::uint64_t index : said) client.say(index);
    EXPECT_EQ(reason_of(client.finish()), "tetstream/MESSAGE_ORDER");
    std::uint64_t index = 0;
    while (patient.read_chunk()) patient.say(index++);
    EXPECT_TRUE(patient.finish().ok());
  }
}

TEST_F(SharedMemoryTest, ClosingItsSocketEndsAStream) {
  start();
  WilfulClient client(socket_);
  client.begin(stream_of(uniform_ball(40)), client.token());
  ASSERT_TRUE(client.has_ring() && client.read_chunk());
  client.close_side();
  EXPECT_EQ(client.finish().error_code(), grpc::StatusCode::CANCELLED);
  EXPECT_TRUE(work_stops());
}

TEST_F(SharedMemoryTest, MessagesThatAreNoneEndAStream) {
  start();
  WilfulClient client(socket_);
  client.begin(stream_of(uniform_ball(40)), client.token());
  ASSERT_TRUE(client.has_ring() && client.read_chunk());
  const std::array<std::byte, 9> nine{};
  EXPECT_TRUE(send_packet(client.side(), nine));
  EXPECT_EQ(client.finish().error_code(), grpc::StatusCode::CANCELLED);
}

TEST_F(SharedMemoryTest, ATokenIsOfOneStreamAtATime) {
  start();
  const v1::StreamMeshRequest request = stream_of(uniform_ball(40));
  WilfulClient first(socket_), second(socket_), stranger(socket_);
  first.begin(request, first.token());
  EXPECT_TRUE(first.has_ring());
  second.begin(request, first.token());
  EXPECT_FALSE(second.has_ring());
  stranger.begin(request, std::string(SideConnection::kTokenBytes, 'x'));
  EXPECT_FALSE(stranger.has_ring());
  EXPECT_TRUE(second.finish().ok());
  EXPECT_TRUE(stranger.finish().ok());
  std::uint64_t index = 0;
  while (first.read_chunk()) first.say(index++);
  EXPECT_TRUE(first.finish().ok());
}

TEST_F(SharedMemoryTest, FilesThatAClientPassesBackAreClosed) {
  start();
  WilfulClient client(socket_);
  client.begin(stream_of(uniform_ball(40)), client.token());
  ASSERT_TRUE(client.has_ring());
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe(ends.data()), 0);
  Descriptor reading(ends[0]), writing(ends[1]);
  ASSERT_TRUE(client.read_chunk());
  ASSERT_TRUE(send_packet(client.side(), side_message(0), writing));
  writing = Descriptor();
  std::uint64_t index = 1;
  while (client.read_chunk()) client.say(index++);
  EXPECT_TRUE(client.finish().ok());
  std::array<char, 1> byte{};
  EXPECT_EQ(::read(reading.number(), byte.data(), 1), 0);  // nobody has the other end
}

TEST_F(SharedMemoryTest, WhoeverHoldsManyConnectionsGetsNoMoreAndOthersGoOn) {
  start();
  // Stored before: whoever claims no connection for a minute has it no longer.
  const v1::MeshRequest request = uniform_ball(20);
  std::vector<Descriptor> held;
  for (std::size_t i = 0; i < SharedMemoryPort::kMostUnclaimedOfUser; ++i) {
    held.push_back(connect_for_packets(socket_ + kSideSocketEnding));
    std::array<std::byte, SideConnection::kTokenBytes> token{};
    Descriptor none;
    ASSERT_TRUE(await_packet(held.back(), token, kGenerousEnd, none));
  }
  const StreamedMesh mesh = received(*local(), request);
  EXPECT_FALSE(mesh.shared_memory);
  held.clear();
  EXPECT_TRUE(eventually([&] { return received(*local(), request).shared_memory; }));
}

}  // namespace
}  // namespace tet::test
