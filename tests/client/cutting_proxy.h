// A network that breaks: forwards TCP connections and cuts each after so many bytes.
#pragma once

#include <arpa/inet.h>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <netinet/in.h>
#include <poll.h>
#include <string>
#include <sys/socket.h>
#include <system_error>
#include <thread>
#include <unistd.h>
#include <vector>

namespace tet::test {

/// Serves one connection at a time, which is all that a client opens.
class CuttingProxy {
 public:
  /// Cuts a connection once `up_bytes` were sent to the server or `down_bytes` came from it.
  CuttingProxy(int server_port, std::uint64_t up_bytes, std::uint64_t down_bytes)
      : server_port_(server_port), limits_{up_bytes, down_bytes} {
    listener_ = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address = loopback(0);
    if (::bind(listener_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0 ||
        ::listen(listener_, 8) != 0) {
      throw std::system_error(errno, std::generic_category(), "cannot listen");
    }
    socklen_t size = sizeof address;
    ::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this] { accept_all(); });
  }
  ~CuttingProxy() {
    closing_ = true;
    thread_.join();
    ::close(listener_);
  }
  CuttingProxy(const CuttingProxy&) = delete;
  CuttingProxy& operator=(const CuttingProxy&) = delete;

  std::string address() const { return "127.0.0.1:" + std::to_string(port_); }
  int cuts() const { return cuts_; }

 private:
  static constexpr int kPollMs = 20;

  static sockaddr_in loopback(int port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    return address;
  }

  void accept_all() {
    while (!closing_) {
      pollfd waiting{listener_, POLLIN, 0};
      if (::poll(&waiting, 1, kPollMs) != 1) continue;
      const int client = ::accept(listener_, nullptr, nullptr);
      const int server = ::socket(AF_INET, SOCK_STREAM, 0);
      const sockaddr_in address = loopback(server_port_);
      if (::connect(server, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) {
        forward(client, server);
      }
      ::close(client);
      ::close(server);
    }
  }

  void forward(int client, int server) {
    std::uint64_t left[2] = {limits_[0], limits_[1]};
    pollfd ends[2] = {{client, POLLIN, 0}, {server, POLLIN, 0}};
    std::vector<char> buffer(std::size_t{64} << 10);
    while (!closing_) {
      if (::poll(ends, 2, kPollMs) <= 0) continue;
      for (int i = 0; i < 2; ++i) {
        if (ends[i].revents == 0) continue;
        const ssize_t count = ::recv(ends[i].fd, buffer.data(), buffer.size(), 0);
        if (count <= 0 || !send_all(ends[1 - i].fd, buffer.data(), count)) return;
        if (static_cast<std::uint64_t>(count) >= left[i]) {
          ++cuts_;
          return;
        }
        left[i] -= static_cast<std::uint64_t>(count);
      }
    }
  }

  static bool send_all(int to, const char* bytes, ssize_t count) {
    while (count > 0) {
      const ssize_t sent = ::send(to, bytes, static_cast<std::size_t>(count), MSG_NOSIGNAL);
      if (sent <= 0) return false;
      bytes += sent;
      count -= sent;
    }
    return true;
  }

  const int server_port_;
  const std::uint64_t limits_[2];
  int listener_ = -1;
  int port_ = 0;
  std::atomic<bool> closing_{false};
  std::atomic<int> cuts_{0};
  std::thread thread_;
};

}  // namespace tet::test
