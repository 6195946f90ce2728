// The whole server in one object: tetstreamd runs one, tests run many.
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include <absl/status/statusor.h>

#include "server/ops/config.h"
#include "server/streams/mesh_engine.h"

namespace tet {

/// Serves from `start` until `stop`. Thread-safe.
class Server {
 public:
  /// Errors: kInternal (store), kUnavailable (cannot listen there), kInvalidArgument (a file of
  /// TLS or tokens that cannot be used).
  static absl::StatusOr<std::unique_ptr<Server>> start(const Config& config);
  /// Stops at once if `stop` was not called.
  ~Server();

  /// host:port, the port being the one that was really taken; or the socket file, as
  /// `unix:PATH`, where there is no port.
  std::string address() const;
  /// 0 where there is a socket file alone.
  int port() const;
  /// The socket file, as `unix:PATH`; empty if there is none.
  std::string unix_address() const;
  /// host:port of the metrics; empty if there are none.
  std::string metrics_address() const;
  /// host:port of the page and of gRPC-Web; empty if there are none.
  std::string http_address() const;

  /// Readiness turns to NOT_SERVING; all goes on as before.
  void announce_end();

  /// Readiness turns to NOT_SERVING, new calls are refused, running ones may go on for `drain`;
  /// then they are handed back with kUnavailable, and a second later, where the client does not
  /// read that, cancelled. Returns when nothing runs any more.
  void stop(std::chrono::seconds drain);

  const MeshEngine& engine() const;
  int running_calls() const;

 private:
  struct Parts;
  explicit Server(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace tet
