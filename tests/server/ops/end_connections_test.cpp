#include "server/ops/end_connections.h"

#include <array>
#include <cerrno>
#include <netinet/in.h>
#include <string>
#include <sys/socket.h>
#include <sys/un.h>
#include <thread>

#include <gtest/gtest.h>

#include "core/base/posix/descriptor.h"
#include "tests/support/test_directory.h"

namespace tet {
namespace {

/// A port of its own, and a connection to it.
struct Connection {
  Connection() {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    auto* const any = reinterpret_cast<sockaddr*>(&address);
    socklen_t size = sizeof address;
    EXPECT_EQ(::bind(listener.number(), any, size), 0);
    EXPECT_EQ(::listen(listener.number(), 4), 0);
    EXPECT_EQ(::getsockname(listener.number(), any, &size), 0);
    port = ntohs(address.sin_port);
    EXPECT_EQ(::connect(client.number(), any, size), 0);
    accepted = Descriptor(::accept(listener.number(), nullptr, nullptr));
  }

  /// Writes until nothing more can be written.
  void fill() const {
    const std::string bytes(1 << 16, 'x');
    while (::send(accepted.number(), bytes.data(), bytes.size(), MSG_NOSIGNAL) > 0) {
    }
  }

  int port = 0;
  Descriptor listener{::socket(AF_INET, SOCK_STREAM, 0)};
  Descriptor client{::socket(AF_INET, SOCK_STREAM, 0)};
  Descriptor accepted;
};

TEST(EndConnections, EndsAWriteToAPeerWhoTakesNothing) {
  const Connection connection;
  std::thread writer([&] { connection.fill(); });  // waits for the peer, which does not read
  // Also where it has not begun to wait: what it writes then fails.
  end_connections(connection.port);
  writer.join();
  EXPECT_EQ(::send(connection.accepted.number(), "x", 1, MSG_NOSIGNAL), -1);
  EXPECT_EQ(errno, EPIPE);
}

TEST(EndConnections, LeavesOtherPortsAndWhoListens) {
  const Connection ended, other;
  end_connections(ended.port);
  EXPECT_EQ(::send(other.accepted.number(), "x", 1, MSG_NOSIGNAL), 1);
  std::array<char, 1> byte{};
  EXPECT_EQ(::recv(other.client.number(), byte.data(), 1, 0), 1);
  EXPECT_EQ(::recv(ended.client.number(), byte.data(), 1, 0), 0);
  const Descriptor next(::socket(AF_INET, SOCK_STREAM, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(ended.port));
  EXPECT_EQ(::connect(next.number(), reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
}

TEST(EndConnections, EndsThoseOfASocketFileAlone) {
  const test::TestDirectory folder;
  const auto listen_at = [](const std::string& path, const Descriptor& listener) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    EXPECT_EQ(
        ::bind(listener.number(), reinterpret_cast<const sockaddr*>(&address), sizeof address),
        0);
    EXPECT_EQ(::listen(listener.number(), 4), 0);
    return address;
  };
  const Connection by_port;
  for (const bool named : {true, false}) {
    const std::string path = folder.file(named ? "named" : "other");
    const Descriptor listener(::socket(AF_UNIX, SOCK_STREAM, 0));
    const Descriptor client(::socket(AF_UNIX, SOCK_STREAM, 0));
    const sockaddr_un address = listen_at(path, listener);
    ASSERT_EQ(
        ::connect(client.number(), reinterpret_cast<const sockaddr*>(&address), sizeof address),
        0);
    const Descriptor accepted(::accept(listener.number(), nullptr, nullptr));
    end_connections(0, folder.file("named"));
    EXPECT_EQ(::send(accepted.number(), "x", 1, MSG_NOSIGNAL), named ? -1 : 1);
  }
  EXPECT_EQ(::send(by_port.accepted.number(), "x", 1, MSG_NOSIGNAL), 1);
}

}  // namespace
}  // namespace tet
