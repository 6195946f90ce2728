#include "proto/wire/loopback.h"

#include <arpa/inet.h>
#include <string>

namespace tet {

namespace {

/// Removes the port, and the brackets of an IPv6 address.
std::string host_of(std::string_view address) {
  if (address.starts_with('[')) return std::string(address.substr(1, address.find(']') - 1));
  return std::string(address.substr(0, address.rfind(':')));
}

}  // namespace

bool is_loopback(std::string_view address) noexcept {
  if (address.starts_with("unix:")) return true;
  const std::string host = host_of(address);
  in_addr ipv4{};
  if (::inet_pton(AF_INET, host.c_str(), &ipv4) == 1) return ntohl(ipv4.s_addr) >> 24 == 127;
  return host == "localhost" || host == "::1";
}

}  // namespace tet
