#include "server/ops/end_connections.h"

#include <charconv>
#include <dirent.h>
#include <netinet/in.h>
#include <string_view>
#include <sys/socket.h>

namespace tet {

namespace {

/// The port that a socket is bound to; 0 of what is no socket, or none of the internet.
int local_port(int descriptor) noexcept {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  if (::getsockname(descriptor, reinterpret_cast<sockaddr*>(&address), &size) != 0) return 0;
  if (address.ss_family == AF_INET) {
    return ntohs(reinterpret_cast<const sockaddr_in&>(address).sin_port);
  }
  if (address.ss_family != AF_INET6) return 0;
  return ntohs(reinterpret_cast<const sockaddr_in6&>(address).sin6_port);
}

bool is_listening(int descriptor) noexcept {
  int yes = 0;
  socklen_t size = sizeof yes;
  return ::getsockopt(descriptor, SOL_SOCKET, SO_ACCEPTCONN, &yes, &size) != 0 || yes != 0;
}

}  // namespace

void end_connections(int port) noexcept {
  DIR* const descriptors = ::opendir("/proc/self/fd");
  if (descriptors == nullptr) return;
  while (const dirent* const entry = ::readdir(descriptors)) {
    const std::string_view name(entry->d_name);
    int descriptor = -1;
    std::from_chars(name.data(), name.data() + name.size(), descriptor);
    if (descriptor < 0 || local_port(descriptor) != port || is_listening(descriptor)) continue;
    ::shutdown(descriptor, SHUT_RDWR);
  }
  ::closedir(descriptors);
}

}  // namespace tet
