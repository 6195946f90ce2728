#include "server/ops/end_connections.h"

#include <charconv>
#include <dirent.h>
#include <netinet/in.h>
#include <string_view>
#include <sys/socket.h>
#include <sys/un.h>

namespace tet {

namespace {

/// Whether a descriptor is a socket that is bound there.
bool is_at(int descriptor, int port, std::string_view socket_path) noexcept {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  if (::getsockname(descriptor, reinterpret_cast<sockaddr*>(&address), &size) != 0)
    return false;
  if (address.ss_family == AF_INET) {
    return port != 0 && ntohs(reinterpret_cast<const sockaddr_in&>(address).sin_port) == port;
  }
  if (address.ss_family == AF_INET6) {
    return port != 0 && ntohs(reinterpret_cast<const sockaddr_in6&>(address).sin6_port) == port;
  }
  // The storage is longer than any address of a file, and was zero.
  return address.ss_family == AF_UNIX && !socket_path.empty() &&
         socket_path == reinterpret_cast<const sockaddr_un&>(address).sun_path;
}

bool is_listening(int descriptor) noexcept {
  int yes = 0;
  socklen_t size = sizeof yes;
  return ::getsockopt(descriptor, SOL_SOCKET, SO_ACCEPTCONN, &yes, &size) != 0 || yes != 0;
}

}  // namespace

void end_connections(int port, std::string_view socket_path) noexcept {
  DIR* const descriptors = ::opendir("/proc/self/fd");
  if (descriptors == nullptr) return;
  while (const dirent* const entry = ::readdir(descriptors)) {
    const std::string_view name(entry->d_name);
    int descriptor = -1;
    std::from_chars(name.data(), name.data() + name.size(), descriptor);
    if (descriptor < 0 || !is_at(descriptor, port, socket_path) || is_listening(descriptor)) {
      continue;
    }
    ::shutdown(descriptor, SHUT_RDWR);
  }
  ::closedir(descriptors);
}

}  // namespace tet
