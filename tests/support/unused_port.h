// A port for a server that may be started on it again.
#pragma once

#include <cstddef>
#include <fstream>
#include <netinet/in.h>
#include <random>
#include <string>
#include <sys/socket.h>
#include <sys/un.h>

#include "core/base/posix/descriptor.h"

namespace tet::test {

/// Nobody else gets it as long as this lives. It lies below those that the system gives to
/// connections, and to whoever asks for any port; other tests are kept off by a name, which
/// waiting.py takes, too.
class UnusedPort {
 public:
  UnusedPort() {
    int lowest = 0;
    std::ifstream("/proc/sys/net/ipv4/ip_local_port_range") >> lowest;
    std::random_device random;
    std::uniform_int_distribution<int> any(10'000, lowest - 1);
    do {
      number_ = any(random);
    } while (!reserve() || !is_free());
  }

  std::string address() const { return "127.0.0.1:" + std::to_string(number_); }

 private:
  bool reserve() {
    reservation_ = Descriptor(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
    const std::string name = "tetstream-test-port-" + std::to_string(number_);
    sockaddr_un place{};
    place.sun_family = AF_UNIX;
    name.copy(place.sun_path + 1, sizeof place.sun_path - 1);  // of no file
    const std::size_t size = offsetof(sockaddr_un, sun_path) + 1 + name.size();
    return binds(reservation_, place, size);
  }

  bool is_free() const {
    sockaddr_in place{};
    place.sin_family = AF_INET;
    place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    place.sin_port = htons(static_cast<in_port_t>(number_));
    return binds(Descriptor(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)), place,
                 sizeof place);
  }

  template <class Place>
  static bool binds(const Descriptor& socket, const Place& place, std::size_t size) {
    return ::bind(socket.number(), reinterpret_cast<const sockaddr*>(&place),
                  static_cast<socklen_t>(size)) == 0;
  }

  int number_ = 0;
  Descriptor reservation_;
};

}  // namespace tet::test
