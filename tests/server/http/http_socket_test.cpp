#include "server/http/http_socket.h"

#include <array>
#include <netinet/in.h>
#include <string>
#include <sys/socket.h>
#include <utility>

#include <gtest/gtest.h>

#include "server/http/http_listener.h"
#include "tests/support/eventually.h"

namespace tet {
namespace {

/// Returns a client of the listener.
Descriptor client_of(const Descriptor& listener) {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  auto* const at = reinterpret_cast<sockaddr*>(&address);
  ::getsockname(listener.number(), at, &size);
  Descriptor client(::socket(address.ss_family, SOCK_STREAM | SOCK_CLOEXEC, 0));
  return ::connect(client.number(), at, size) == 0 ? std::move(client) : Descriptor();
}

TEST(HttpSocket, TellsWhatTheOtherSideHasNotTakenYet) {
  const auto listener = listen_for_http({"127.0.0.1", 0});
  ASSERT_TRUE(listener.ok()) << listener.status();
  const Descriptor client = client_of(listener->descriptor);
  AcceptedSocket accepted;
  const auto is_accepted = [&] {
    return accept_http(listener->descriptor, std::chrono::seconds(20), accepted) ==
           Accepted::kOne;
  };
  ASSERT_TRUE(test::eventually(is_accepted));
  HttpSocket socket(std::move(accepted.descriptor), nullptr, accepted.peer);
  EXPECT_EQ(socket.unacknowledged(), 0);
  // Until the client's kernel has no room for more, and the rest waits for its reader.
  const std::string much(1 << 20, 'x');
  std::size_t given = 0, left = 0;
  while (left == 0) {
    for (std::size_t written = 0; socket.write(much, true, written) == Io::kDone;) {
      given += written;
    }
    left = socket.unacknowledged();
  }
  EXPECT_LE(left, given);
  std::array<char, 64 << 10> read{};
  for (std::size_t taken = 0; taken < given;) {
    const ssize_t got = ::recv(client.number(), read.data(), read.size(), 0);
    ASSERT_GT(got, 0);
    taken += static_cast<std::size_t>(got);
  }
  EXPECT_TRUE(test::eventually([&] { return socket.unacknowledged() == 0; }));
}

}  // namespace
}  // namespace tet
