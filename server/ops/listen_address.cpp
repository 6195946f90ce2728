#include "server/ops/listen_address.h"

#include <absl/strings/numbers.h>
#include <absl/strings/str_format.h>

namespace tet {

std::string ListenAddress::bare_host() const {
  return host.size() > 2 && host.front() == '[' ? host.substr(1, host.size() - 2) : host;
}

absl::StatusOr<ListenAddress> parse_listen_address(std::string_view key,
                                                   const std::string& text) {
  const std::size_t colon = text.rfind(':');
  ListenAddress address;
  if (colon != std::string::npos && colon > 0 &&
      absl::SimpleAtoi(text.substr(colon + 1), &address.port) && address.port >= 0 &&
      address.port <= 65'535) {
    address.host = text.substr(0, colon);
    return address;
  }
  return absl::InvalidArgumentError(absl::StrFormat("%s \"%s\" is not host:port", key, text));
}

}  // namespace tet
