#include "server/http/grpc_place.h"

#include <absl/strings/match.h>
#include <nlohmann/json.hpp>

#include "server/ops/listen_address.h"

namespace tet {

namespace {

/// Whether these stand for all addresses of a machine.
bool is_wildcard(const std::string& bare_host) {
  return bare_host == "0.0.0.0" || bare_host == "::" || bare_host == "*" ||
         bare_host == "0:0:0:0:0:0:0:0";
}

}  // namespace

std::string grpc_place_json(const std::string& address, bool tls) {
  nlohmann::json place{{"tls", tls}};
  const auto read = parse_listen_address("listen", address);
  if (!read.ok() || absl::StartsWith(address, "unix:")) {
    place["address"] = address;
  } else {
    place["host"] = is_wildcard(read->bare_host()) ? "" : read->host;
    place["port"] = read->port;
  }
  return place.dump() + "\n";
}

}  // namespace tet
