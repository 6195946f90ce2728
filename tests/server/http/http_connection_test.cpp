#include "server/http/http_connection.h"

#include <array>
#include <chrono>
#include <map>
#include <memory>
#include <new>
#include <string>
#include <string_view>
#include <sys/socket.h>
#include <sys/time.h>
#include <utility>

#include <gtest/gtest.h>

namespace tet {
namespace {

/// Two ends of a connection; whoever reads the first waits no longer than anybody would.
std::array<Descriptor, 2> ends() {
  std::array<int, 2> numbers{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, numbers.data()) != 0) return {};
  const timeval patience{.tv_sec = 600, .tv_usec = 0};
  ::setsockopt(numbers[0], SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  return {Descriptor(numbers[0]), Descriptor(numbers[1])};
}

/// Connections on a loop that has not begun, or that a test has begun.
class HttpConnectionTest : public testing::Test {
 protected:
  ~HttpConnectionTest() override {
    loop_.stop();
    connections_.clear();  // before what they share
  }

  /// The client's end of a connection that has sent this.
  Descriptor connect(std::string_view sent) {
    auto [client, served] = ends();
    EXPECT_EQ(::send(client.number(), sent.data(), sent.size(), 0),
              static_cast<ssize_t>(sent.size()));
    const int number = served.number();
    connections_[number] = std::make_shared<HttpConnection>(
        shared_, HttpSocket(std::move(served), nullptr, "ipv4:127.0.0.1:1"));
    connections_[number]->open();
    return std::move(client);
  }

  EventLoop loop_{std::chrono::milliseconds(10), [] {}};
  HttpPlace place_{.loop = loop_,
                   .gate = HttpGate(true, ""),
                   .page = {},
                   .open_api = {},
                   .grpc_place = {},
                   .stub = nullptr,
                   .metrics = nullptr,
                   .history = nullptr,
                   .ready = [] { return true; }};
  std::map<int, std::shared_ptr<HttpConnection>> connections_;
  HttpShared shared_{.place = place_,
                     .limits = {},
                     .refused = [](int) {},
                     .closed = [this](int number) { connections_.erase(number); },
                     .make_room = [](const HttpConnection&) { return false; }};
};

constexpr std::string_view kMetrics = "GET /metrics HTTP/1.1\r\nHost: localhost\r\n\r\n";

TEST_F(HttpConnectionTest, IsClosedWhereMemoryEndsAmidARequest) {
  place_.metrics = []() -> std::string { throw std::bad_alloc(); };
  const Descriptor client = connect("");
  loop_.start();
  ASSERT_EQ(::send(client.number(), kMetrics.data(), kMetrics.size(), 0),
            static_cast<ssize_t>(kMetrics.size()));
  char answer = 0;
  EXPECT_EQ(::recv(client.number(), &answer, 1, 0), 0) << "it is open";
}

TEST_F(HttpConnectionTest, LeavesOthersTheirTurnsHoweverMuchItAsks) {
  constexpr int kAsked = 100;
  int answered = 0, before_the_other = -1;
  place_.metrics = [&] { return std::to_string(++answered); };
  place_.ready = [&] {
    before_the_other = answered;
    return true;
  };
  std::string many;
  for (int i = 0; i < kAsked; ++i) many += kMetrics;
  const Descriptor one = connect(many);
  const Descriptor other = connect("GET /readyz HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_EQ(before_the_other, 8);
  loop_.start();
  std::array<char, 4096> some{};
  std::string all;
  while (all.find("\r\n\r\n100") == std::string::npos) {
    const ssize_t got = ::recv(one.number(), some.data(), some.size(), 0);
    ASSERT_GT(got, 0) << all;
    all.append(some.data(), static_cast<std::size_t>(got));
  }
  EXPECT_EQ(::recv(other.number(), some.data(), 12, 0), 12);
  EXPECT_EQ(std::string_view(some.data(), 12), "HTTP/1.1 200");
}

}  // namespace
}  // namespace tet
