// Shared memory of clients that are another user than the server: what they keep is given up.
#include <algorithm>
#include <array>
#include <fcntl.h>
#include <filesystem>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include "tests/core/plan/meshing.h"
#include "tests/server/shared_memory_fixture.h"

namespace tet::test {
namespace {

constexpr uid_t kNobody = 65534;

/// A connection to a socket file that another user has made, in a process of its own.
Descriptor connected_by_nobody(const std::string& path) {
  std::array<int, 2> ends{};
  EXPECT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET, 0, ends.data()), 0);
  const Descriptor ours(ends[0]), theirs(ends[1]);
  const std::array<std::byte, 1> message{};
  const pid_t child = ::fork();
  if (child == 0) {
    const bool changed = ::setresuid(kNobody, kNobody, kNobody) == 0;
    const Descriptor made = changed ? connect_for_packets(path) : Descriptor();
    ::_exit(made.is_open() && send_packet(theirs, message, made) ? 0 : 1);
  }
  int ended = -1;
  EXPECT_EQ(::waitpid(child, &ended, 0), child);
  EXPECT_EQ(ended, 0);
  std::array<std::byte, 1> taken{};
  Descriptor passed;
  EXPECT_TRUE(await_packet(ours, taken, kGenerousEnd, passed));
  return passed;
}

class OtherUser : public SharedMemoryTest {
 protected:
  void SetUp() override {
    if (::geteuid() != 0) GTEST_SKIP() << "only root can become another user";
    std::filesystem::permissions(folder_.path(), std::filesystem::perms(0755));
    config_.listen_unix_mode = "666";
    start();
  }
  Descriptor connected() const { return connected_by_nobody(socket_ + kSideSocketEnding); }

  static bool has_pages(const Descriptor& memory) {
    struct stat told {};
    EXPECT_EQ(::fstat(memory.number(), &told), 0);
    return told.st_blocks > 0;
  }
};

TEST_F(OtherUser, WhatItKeepsIsGivenUpOnceNobodyUsesIt) {
  WilfulClient client(socket_, connected());
  client.begin(stream_of(uniform_ball(30)), client.token());
  ASSERT_TRUE(client.has_ring());
  const Descriptor memory = client.take_memory();
  const auto mapped = SharedMemory::map(memory, 4096);
  ASSERT_TRUE(mapped.ok()) << mapped.status();
  EXPECT_TRUE(client.follow().ok());
  EXPECT_TRUE(has_pages(memory));  // for its next stream
  client.close_side();
  EXPECT_TRUE(eventually([&] { return !has_pages(memory); }));
  EXPECT_TRUE(eventually([&] { return engine().send_budget.used_bytes() == 0; }));
}

TEST_F(OtherUser, WhatItKeepsOfAStreamThatFailedIsGivenUp) {
  WilfulClient client(socket_, connected());
  client.begin(stream_of(uniform_ball(40)), client.token());
  ASSERT_TRUE(client.has_ring() && client.read_chunk());
  const Descriptor memory = client.take_memory();
  EXPECT_TRUE(has_pages(memory));
  client.say(7);  // which it was not told of
  EXPECT_FALSE(client.finish().ok());
  EXPECT_TRUE(eventually([&] { return !has_pages(memory); }));
}

TEST_F(OtherUser, CanOnlyReadAndReadsTheSameBytes) {
  WilfulClient client(socket_, connected());
  const v1::MeshRequest request = uniform_ball(12);
  const StreamedMesh whole = received(*client_, request);
  client.begin(stream_of(request), client.token());
  ASSERT_TRUE(client.has_ring() && client.read_chunk());
  const Descriptor memory = client.take_memory();
  EXPECT_EQ(::fcntl(memory.number(), F_GETFL) & O_ACCMODE, O_RDONLY);
  struct stat told {};
  ASSERT_EQ(::fstat(memory.number(), &told), 0);
  EXPECT_EQ(told.st_mode & 0777, 0400U);
  const auto mapped = SharedMemory::map(memory, static_cast<std::size_t>(told.st_size));
  ASSERT_TRUE(mapped.ok()) << mapped.status();
  // The first chunk's positions come first in its block.
  const auto bytes = std::min<std::size_t>(
      whole.mesh.positions.size(),
      static_cast<std::size_t>(client.chunk().vertex_count()) * 3 * sizeof(float));
  EXPECT_GT(bytes, 0U);
  EXPECT_TRUE(
      std::ranges::equal(whole.mesh.positions.bytes().first(bytes),
                         mapped->bytes().subspan(
                             static_cast<std::size_t>(client.chunk().shared_offset()), bytes)));
  client.say(0);
  EXPECT_TRUE(client.follow(1).ok());
}

}  // namespace
}  // namespace tet::test
