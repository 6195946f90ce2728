// The port that browsers and curl speak to: gRPC-Web, JSON, uploads, metrics and the page.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <absl/status/statusor.h>
#include <absl/strings/string_view.h>
#include <grpcpp/server.h>

#include "server/ops/config.h"
#include "server/ops/metric_history.h"
#include "server/ops/metrics.h"
#include "server/rpc/tls.h"

namespace tet {

/// What the port needs of the server; all of it outlives the port.
struct HttpService {
  grpc::Server& server;      ///< whose calls it makes
  ServerTls* tls = nullptr;  ///< null where the port is plain
  std::function<std::string()> metrics;
  std::function<MetricHistory::Telling(absl::string_view)> history;
  std::function<bool()> ready;
  std::string grpc_address;  ///< host:port that gRPC's port was opened as
};

/// Serves on one thread of its own, whatever the number of connections.
class HttpPort {
 public:
  /// Errors: kInvalidArgument (http_listen is not host:port, http_page holds no page),
  /// kUnavailable (cannot listen there).
  static absl::StatusOr<std::unique_ptr<HttpPort>> open(const Config& config,
                                                        HttpService service);
  /// Closes all connections, and waits until their calls have ended.
  ~HttpPort();

  /// host:port, the port being the one that was really taken.
  const std::string& address() const;
  /// May be called by any thread.
  std::vector<Reading> readings() const;

 private:
  struct Impl;
  explicit HttpPort(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace tet
