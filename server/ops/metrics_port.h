// The operators' port: metrics and health over plain HTTP, apart from the service.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include <absl/status/statusor.h>

namespace tet {

/// What the port answers with; called on its threads.
struct MetricsPages {
  std::function<std::string()> metrics;  ///< the body of /metrics
  std::function<bool()> ready;           ///< whether /readyz is 200 or 503
};

/// Serves /metrics, /healthz (200 while the process lives) and /readyz on two threads of its
/// own, one request a connection, at most a few connections at once; the others wait in the
/// kernel.
class MetricsPort {
 public:
  /// `listen` is host:port; port 0 takes a free one.
  /// Errors: kInvalidArgument (not host:port), kUnavailable (cannot listen there).
  static absl::StatusOr<std::unique_ptr<MetricsPort>> open(const std::string& listen,
                                                           MetricsPages pages);
  ~MetricsPort();

  /// host:port, the port being the one that was really taken.
  const std::string& address() const;

 private:
  struct Impl;
  explicit MetricsPort(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace tet
