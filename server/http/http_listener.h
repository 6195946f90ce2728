// A listening socket of the HTTP port.
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include <absl/status/statusor.h>

#include "core/base/posix/descriptor.h"
#include "server/http/listener_watch.h"
#include "server/ops/listen_address.h"

namespace tet {

struct HttpListener {
  Descriptor descriptor;
  std::string address;  ///< host:port, the port being the one that was really taken
};

/// Errors: kUnavailable (cannot listen there).
absl::StatusOr<HttpListener> listen_for_http(const ListenAddress& address);

struct AcceptedSocket {
  Descriptor descriptor;
  std::string peer;  ///< as gRPC writes it
};

/// Takes the next connection into `accepted`, where there is one; the kernel asks it each
/// `keepalive` of silence whether it is still there, and ends one that does not say so.
Accepted accept_http(const Descriptor& listener,
                     std::chrono::seconds keepalive,
                     AcceptedSocket& accepted);

}  // namespace tet
