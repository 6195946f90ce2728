#include "core/base/posix/packet_socket.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <linux/sockios.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/un.h>

namespace tet {

namespace {

constexpr int kKind = SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC;

/// Returns nothing where the path is too long.
std::optional<sockaddr_un> address_of(const std::string& path) noexcept {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) return std::nullopt;
  path.copy(address.sun_path, path.size());
  return address;
}

const sockaddr* any(const sockaddr_un& address) noexcept {
  return reinterpret_cast<const sockaddr*>(&address);
}

/// Room for more files than anybody should send, so that the system closes none unseen.
using Control = std::array<char, CMSG_SPACE(4 * sizeof(int))>;

/// Takes the only file of a message; closes all where there are several.
Descriptor file_of(msghdr& header) noexcept {
  Descriptor first;
  std::size_t files = 0;
  for (cmsghdr* part = CMSG_FIRSTHDR(&header); part != nullptr;
       part = CMSG_NXTHDR(&header, part)) {
    if (part->cmsg_level != SOL_SOCKET || part->cmsg_type != SCM_RIGHTS) continue;
    const std::size_t count = (part->cmsg_len - CMSG_LEN(0)) / sizeof(int);
    for (std::size_t i = 0; i < count; ++i) {
      int number = -1;
      std::memcpy(&number, CMSG_DATA(part) + i * sizeof(int), sizeof number);
      Descriptor file(number);
      if (++files == 1) first = std::move(file);
    }
  }
  return files == 1 ? std::move(first) : Descriptor();
}

/// Waits until one of them can be read, for `patience` at most. Signals that have handlers
/// interrupt poll(2), and neither make it longer nor end it.
void wait_for_any(std::span<pollfd> any, std::chrono::milliseconds patience) noexcept {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point end = Clock::now() + patience;
  while (::poll(any.data(), any.size(), static_cast<int>(patience.count())) < 0 &&
         errno == EINTR) {
    patience = std::max(std::chrono::ceil<std::chrono::milliseconds>(end - Clock::now()),
                        std::chrono::milliseconds(0));
  }
}

}  // namespace

Descriptor listen_for_packets(const std::string& path, int backlog) noexcept {
  Descriptor socket(::socket(AF_UNIX, kKind, 0));
  const auto address = address_of(path);
  const bool good = socket.is_open() && address &&
                    ::bind(socket.number(), any(*address), sizeof *address) == 0 &&
                    ::listen(socket.number(), backlog) == 0;
  return good ? std::move(socket) : Descriptor();
}

Descriptor accept_packets(const Descriptor& listener) noexcept {
  return Descriptor(
      ::accept4(listener.number(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
}

Descriptor connect_for_packets(const std::string& path) noexcept {
  Descriptor socket(::socket(AF_UNIX, kKind, 0));
  const auto address = address_of(path);
  const bool good = socket.is_open() && address &&
                    ::connect(socket.number(), any(*address), sizeof *address) == 0;
  return good ? std::move(socket) : Descriptor();
}

std::optional<uid_t> user_of_peer(const Descriptor& socket) noexcept {
  ucred peer{};
  socklen_t size = sizeof peer;
  if (::getsockopt(socket.number(), SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0) {
    return std::nullopt;
  }
  return peer.uid;
}

bool send_packet(const Descriptor& socket,
                 std::span<const std::byte> message,
                 const Descriptor& passed) noexcept {
  iovec bytes{const_cast<std::byte*>(message.data()), message.size()};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int))> control{};
  msghdr header{};
  header.msg_iov = &bytes;
  header.msg_iovlen = 1;
  if (passed.is_open()) {
    header.msg_control = control.data();
    header.msg_controllen = control.size();
    cmsghdr* const part = CMSG_FIRSTHDR(&header);
    part->cmsg_level = SOL_SOCKET;
    part->cmsg_type = SCM_RIGHTS;
    part->cmsg_len = CMSG_LEN(sizeof(int));
    const int number = passed.number();
    std::memcpy(CMSG_DATA(part), &number, sizeof number);
  }
  ssize_t sent = -1;
  do {
    sent = ::sendmsg(socket.number(), &header, MSG_NOSIGNAL | MSG_DONTWAIT);
  } while (sent < 0 && errno == EINTR);
  return sent == static_cast<ssize_t>(message.size());
}

bool send_packet(const Descriptor& socket, std::span<const std::byte> message) noexcept {
  return send_packet(socket, message, Descriptor());
}

bool has_untaken(const Descriptor& socket) noexcept {
  int bytes = 0;
  return ::ioctl(socket.number(), SIOCOUTQ, &bytes) != 0 || bytes > 0;
}

bool is_quiet(const Descriptor& socket) noexcept {
  pollfd either{socket.number(), POLLIN | POLLRDHUP, 0};
  return socket.is_open() && ::poll(&either, 1, 0) == 0;
}

// Without room for files the system closes those that come. A message of no bytes looks like
// the end, and is none of anybody's.
Packet take_any_packet(const Descriptor& socket,
                       std::span<std::byte> message,
                       std::size_t& size) noexcept {
  iovec bytes{message.data(), message.size()};
  msghdr header{};
  header.msg_iov = &bytes;
  header.msg_iovlen = 1;
  ssize_t taken = -1;
  do {
    taken = ::recvmsg(socket.number(), &header, MSG_DONTWAIT);
  } while (taken < 0 && errno == EINTR);
  if (taken < 0) return errno == EAGAIN ? Packet::kNone : Packet::kEnd;
  if (taken == 0 || (header.msg_flags & MSG_TRUNC) != 0) return Packet::kEnd;
  size = static_cast<std::size_t>(taken);
  return Packet::kTaken;
}

Packet take_packet(const Descriptor& socket, std::span<std::byte> message) noexcept {
  std::size_t size = 0;
  const Packet packet = take_any_packet(socket, message, size);
  return packet == Packet::kTaken && size != message.size() ? Packet::kEnd : packet;
}

Packet await_any_packet(const Descriptor& socket,
                        std::span<std::byte> message,
                        std::size_t& size,
                        std::chrono::milliseconds patience,
                        int stop) noexcept {
  const Packet at_once = take_any_packet(socket, message, size);
  if (at_once != Packet::kNone) return at_once;
  std::array<pollfd, 2> either{{{socket.number(), POLLIN, 0}, {stop, POLLIN, 0}}};
  wait_for_any(either, patience);
  return take_any_packet(socket, message, size);
}

bool await_packet(const Descriptor& socket,
                  std::span<std::byte> message,
                  std::chrono::milliseconds patience,
                  Descriptor& passed,
                  int stop) noexcept {
  std::array<pollfd, 2> either{{{socket.number(), POLLIN, 0}, {stop, POLLIN, 0}}};
  wait_for_any(either, patience);
  if (either[0].revents == 0) return false;
  iovec bytes{message.data(), message.size()};
  alignas(cmsghdr) Control control{};
  msghdr header{};
  header.msg_iov = &bytes;
  header.msg_iovlen = 1;
  header.msg_control = control.data();
  header.msg_controllen = control.size();
  const ssize_t taken = ::recvmsg(socket.number(), &header, MSG_DONTWAIT | MSG_CMSG_CLOEXEC);
  if (taken < 0) return false;
  passed = file_of(header);
  return taken == static_cast<ssize_t>(message.size()) && (header.msg_flags & MSG_TRUNC) == 0;
}

}  // namespace tet
