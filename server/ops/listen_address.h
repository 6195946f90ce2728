// host:port as a setting says it.
#pragma once

#include <string>
#include <string_view>

#include <absl/status/statusor.h>

namespace tet {

struct ListenAddress {
  std::string host;  ///< as it was given, with the brackets of an IPv6 address
  int port = 0;      ///< 0 takes a free one

  /// Returns the host without brackets, which only the text of an address with a port needs.
  std::string bare_host() const;
};

/// Errors: kInvalidArgument (not host:port), naming the setting `key`.
absl::StatusOr<ListenAddress> parse_listen_address(std::string_view key,
                                                   const std::string& text);

}  // namespace tet
