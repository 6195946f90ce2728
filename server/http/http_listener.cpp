#include "server/http/http_listener.h"

#include <algorithm>
#include <arpa/inet.h>
#include <array>
#include <cerrno>
#include <chrono>
#include <memory>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <utility>

#include <absl/strings/str_cat.h>

namespace tet {

namespace {

constexpr int kBacklog = 256;

struct AddressesFree {
  void operator()(addrinfo* list) const noexcept { ::freeaddrinfo(list); }
};

Descriptor listen_at(const addrinfo& where) {
  Descriptor socket(::socket(where.ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  const int yes = 1;
  ::setsockopt(socket.number(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  const bool good = socket.is_open() &&
                    ::bind(socket.number(), where.ai_addr, where.ai_addrlen) == 0 &&
                    ::listen(socket.number(), kBacklog) == 0;
  return good ? std::move(socket) : Descriptor();
}

int port_of(const sockaddr_storage& address) {
  const bool v6 = address.ss_family == AF_INET6;
  return ntohs(v6 ? reinterpret_cast<const sockaddr_in6&>(address).sin6_port
                  : reinterpret_cast<const sockaddr_in&>(address).sin_port);
}

std::string peer_text(const sockaddr_storage& address) {
  std::array<char, INET6_ADDRSTRLEN> text{};
  if (address.ss_family == AF_INET6) {
    ::inet_ntop(AF_INET6, &reinterpret_cast<const sockaddr_in6&>(address).sin6_addr,
                text.data(), text.size());
    return absl::StrCat("ipv6:%5B", text.data(), "%5D:", port_of(address));
  }
  ::inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in&>(address).sin_addr, text.data(),
              text.size());
  return absl::StrCat("ipv4:", text.data(), ":", port_of(address));
}

}  // namespace

absl::StatusOr<HttpListener> listen_for_http(const ListenAddress& asked) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
  addrinfo* found = nullptr;
  const std::string host = asked.bare_host(), port = absl::StrCat(asked.port);
  const int failed = ::getaddrinfo(host.c_str(), port.c_str(), &hints, &found);
  const std::unique_ptr<addrinfo, AddressesFree> list(failed == 0 ? found : nullptr);
  for (const addrinfo* where = list.get(); where != nullptr; where = where->ai_next) {
    HttpListener listener{listen_at(*where), {}};
    if (!listener.descriptor.is_open()) continue;
    sockaddr_storage taken{};
    socklen_t size = sizeof taken;
    ::getsockname(listener.descriptor.number(), reinterpret_cast<sockaddr*>(&taken), &size);
    listener.address = absl::StrCat(asked.host, ":", port_of(taken));
    return listener;
  }
  return absl::UnavailableError(
      absl::StrCat("cannot listen on ", asked.host, ":", asked.port, " for HTTP"));
}

namespace {

void set_option(int socket, int level, int name, int value) {
  ::setsockopt(socket, level, name, &value, sizeof value);
}

/// A peer that vanished without a word, as laptops do that sleep, has to be asked.
void keep_asking(int socket, std::chrono::seconds each) {
  constexpr int kQuestions = 3;
  const auto seconds = static_cast<int>(each.count());
  set_option(socket, SOL_SOCKET, SO_KEEPALIVE, 1);
  set_option(socket, IPPROTO_TCP, TCP_KEEPIDLE,
             std::min(seconds, 32'767));  // the kernel's most
  set_option(socket, IPPROTO_TCP, TCP_KEEPINTVL, std::clamp(seconds / kQuestions, 1, 32'767));
  set_option(socket, IPPROTO_TCP, TCP_KEEPCNT, kQuestions);
}

}  // namespace

Accepted accept_http(const Descriptor& listener,
                     std::chrono::seconds keepalive,
                     AcceptedSocket& accepted) {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  accepted.descriptor =
      Descriptor(::accept4(listener.number(), reinterpret_cast<sockaddr*>(&address), &size,
                           SOCK_NONBLOCK | SOCK_CLOEXEC));
  if (!accepted.descriptor.is_open()) return accepted_none(errno);
  set_option(accepted.descriptor.number(), IPPROTO_TCP, TCP_NODELAY, 1);
  keep_asking(accepted.descriptor.number(), keepalive);
  accepted.peer = peer_text(address);
  return Accepted::kOne;
}

}  // namespace tet
