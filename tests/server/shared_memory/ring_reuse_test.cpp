// Memory that a connection's streams use one after the other, and never two at once.
#include <sys/stat.h>

#include <gtest/gtest.h>

#include "tests/core/plan/meshing.h"
#include "tests/server/reason_of.h"
#include "tests/server/shared_memory_fixture.h"

namespace tet::test {
namespace {

/// What no two memories that are there at once have in common.
ino_t number_of(const Descriptor& memory) {
  struct stat told {};
  EXPECT_EQ(::fstat(memory.number(), &told), 0);
  return told.st_ino;
}

class RingReuse : public SharedMemoryTest {
 protected:
  /// Follows a whole stream; returns the number of its memory, and 0 where it has none.
  ino_t stream(WilfulClient& client, const v1::MeshRequest& request) {
    client.begin(stream_of(request), client.token());
    const bool shared = client.has_ring();
    const ino_t number = shared ? number_of(client.take_memory()) : 0;
    if (!shared) {
      EXPECT_TRUE(client.finish().ok());
    } else {
      EXPECT_TRUE(client.follow().ok());
    }
    return number;
  }
};

TEST_F(RingReuse, AConnectionsNextStreamHasItsMemory) {
  start();
  WilfulClient client(socket_);
  const ino_t first = stream(client, uniform_ball(40));
  EXPECT_NE(first, 0u);
  EXPECT_GT(kept_bytes(), 0u);
  EXPECT_EQ(engine().send_budget.used_bytes(), kept_bytes());
  EXPECT_EQ(stream(client, uniform_ball(30)), first);
  EXPECT_EQ(stream(client, uniform_ball(12)), first);  // which needs less
  WilfulClient other(socket_);
  EXPECT_NE(stream(other, uniform_ball(40)), first);
}

TEST_F(RingReuse, MeshesAreTheSameBytesOneAfterTheOther) {
  start();
  const auto client = local();
  std::vector<v1::MeshRequest> requests;
  for (const int radius : {12, 30, 20, 40, 12}) requests.push_back(uniform_ball(radius));
  for (const v1::MeshRequest& request : requests) {
    const StreamedMesh by_port = received(*client_, request);
    const StreamedMesh shared = received(*client, request);
    EXPECT_TRUE(shared.shared_memory);
    EXPECT_TRUE(same_bytes(by_port.mesh, shared.mesh));
    EXPECT_EQ(tets_by_chunks(*client, request), by_port.mesh.header.tet_count);
  }
  EXPECT_EQ(shared_streams(), static_cast<std::int64_t>(2 * requests.size()));
}

TEST_F(RingReuse, AStreamThatRunsHasItAlone) {
  start();
  const v1::MeshRequest request = uniform_ball(40);
  WilfulClient client(socket_), twin(socket_);
  const ino_t first = stream(client, request);
  client.begin(stream_of(request), client.token());
  ASSERT_TRUE(client.has_ring() && client.read_chunk());
  EXPECT_EQ(number_of(client.take_memory()), first);
  twin.begin(stream_of(request), client.token());
  EXPECT_FALSE(twin.has_ring());
  EXPECT_TRUE(twin.finish().ok());
  client.say(0);
  EXPECT_TRUE(client.follow(1).ok());
}

TEST_F(RingReuse, EndsOnlyOnceAllIsAcknowledged) {
  start();
  const v1::StreamMeshRequest request = stream_of(uniform_ball(12));
  const std::string reason = reason_when_stalled([&] {
    WilfulClient client(socket_);
    client.begin(request, client.token());
    EXPECT_TRUE(client.has_ring());
    EXPECT_TRUE(client.read_trailer());
    const PassingTime passing(*server_, config_.stall_seconds);
    return client.finish();
  });
  EXPECT_EQ(reason, "tetstream/CLIENT_STALLED");
  EXPECT_TRUE(work_stops());
  EXPECT_EQ(kept_bytes(), 0u);
}

TEST_F(RingReuse, AStreamThatFailedLeavesNothing) {
  start();
  const v1::MeshRequest request = uniform_ball(40);
  WilfulClient client(socket_);
  client.begin(stream_of(request), client.token());
  ASSERT_TRUE(client.has_ring() && client.read_chunk());
  client.say(7);
  EXPECT_EQ(reason_of(client.finish()), "tetstream/MESSAGE_ORDER");
  EXPECT_EQ(kept_bytes(), 0u);
  EXPECT_EQ(stream(client, request), 0u);
  EXPECT_TRUE(eventually([&] { return engine().send_budget.used_bytes() == 0; }));
}

TEST_F(RingReuse, WhoeverSpeaksOutOfTurnIsListenedToNoMore) {
  start();
  const v1::MeshRequest request = uniform_ball(20);
  WilfulClient client(socket_);
  ASSERT_NE(stream(client, request), 0u);
  client.say(0);
  EXPECT_TRUE(
      eventually([&] { return !is_quiet(client.side()); }));  // the server's end is gone
  EXPECT_EQ(stream(client, request), 0u);
}

TEST_F(RingReuse, WhoeverTakesNoMemoryIsHandedNoMore) {
  start();
  const v1::StreamMeshRequest request = stream_of(uniform_ball(20));
  WilfulClient client(socket_);
  client.begin(request, client.token());
  EXPECT_TRUE(client.has_ring());
  EXPECT_TRUE(client.follow().ok());
  client.begin(request, client.token());
  EXPECT_FALSE(client.has_ring());
  EXPECT_TRUE(client.finish().ok());
}

TEST_F(RingReuse, IdleMemoryIsGivenUpForWhoeverNeedsIt) {
  config_.send_bytes = std::uint64_t{15} << 20;  // two rings at once, one of them idle
  start();
  const v1::StreamMeshRequest request = stream_of(uniform_ball(40));
  WilfulClient idle(socket_), second(socket_), third(socket_);
  ASSERT_NE(stream(idle, uniform_ball(40)), 0u);
  EXPECT_GT(kept_bytes(), 0u);
  second.begin(request, second.token());
  EXPECT_TRUE(second.has_ring());
  EXPECT_GT(kept_bytes(), 0u);
  third.begin(request, third.token());
  EXPECT_TRUE(third.has_ring());
  EXPECT_EQ(kept_bytes(), 0u);
  EXPECT_TRUE(second.follow().ok());
  EXPECT_TRUE(third.follow().ok());
}

TEST_F(RingReuse, AClientGoesOnWhenTheServerHasForgottenIt) {
  start();
  const v1::MeshRequest request = uniform_ball(20);
  const auto client = local();
  EXPECT_TRUE(received(*client, request).shared_memory);
  restart();
  EXPECT_TRUE(received(*client, mesh_of(ball_file(20))).shared_memory);
}

}  // namespace
}  // namespace tet::test
