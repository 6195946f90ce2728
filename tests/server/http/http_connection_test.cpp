#include "server/http/http_connection.h"

#include <array>
#include <memory>
#include <new>
#include <string>
#include <string_view>
#include <sys/socket.h>
#include <sys/time.h>

#include <gtest/gtest.h>

namespace tet {
namespace {

/// Two ends of a connection; whoever reads the first waits no longer than anybody would.
std::array<Descriptor, 2> ends() {
  std::array<int, 2> numbers{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, numbers.data()) != 0) return {};
  const timeval patience{.tv_sec = 60, .tv_usec = 0};
  ::setsockopt(numbers[0], SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  return {Descriptor(numbers[0]), Descriptor(numbers[1])};
}

TEST(HttpConnection, IsClosedWhereMemoryEndsAmidARequest) {
  using namespace std::chrono_literals;
  EventLoop loop(10ms, [] {});
  HttpPlace place{.loop = loop,
                  .gate = HttpGate(true, ""),
                  .page = {},
                  .open_api = {},
                  .grpc_place = {},
                  .stub = nullptr,
                  .metrics = []() -> std::string { throw std::bad_alloc(); },
                  .history = nullptr,
                  .ready = [] { return true; }};
  auto [client, served] = ends();
  std::shared_ptr<HttpConnection> connection;
  HttpShared shared{.place = place,
                    .limits = {},
                    .refused = [](int) {},
                    .closed = [&](int) { connection = nullptr; },
                    .make_room = [](const HttpConnection&) { return false; }};
  connection = std::make_shared<HttpConnection>(
      shared, HttpSocket(std::move(served), nullptr, "ipv4:127.0.0.1:1"));
  connection->open();
  loop.start();
  constexpr std::string_view kRequest = "GET /metrics HTTP/1.1\r\nHost: localhost\r\n\r\n";
  ASSERT_EQ(::send(client.number(), kRequest.data(), kRequest.size(), 0),
            static_cast<ssize_t>(kRequest.size()));
  char answer = 0;
  EXPECT_EQ(::recv(client.number(), &answer, 1, 0), 0) << "it is open";
  loop.stop();
}

}  // namespace
}  // namespace tet
