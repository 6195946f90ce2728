// Whether the server serves, by gRPC's own protocol: grpc.health.v1.
//
// gRPC's implementation has no limit on Watch, and counts none: ten thousand of them are ten
// thousand calls that nobody sees. This one knows nothing of tokens either: whoever balances
// the load has none.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <absl/status/status.h>

#include "grpc/health/v1/health.grpc.pb.h"
#include "server/ops/metrics.h"
#include "server/rpc/admission.h"

namespace tet {

/// Answers Check, and tells Watch of each change. Thread-safe. Outlives the server that it is
/// registered with.
class HealthService final : public grpc::health::v1::Health::CallbackService {
 public:
  using Request = grpc::health::v1::HealthCheckRequest;
  using Response = grpc::health::v1::HealthCheckResponse;

  /// `watches` may be under way at once; a client is the host that it calls from.
  explicit HealthService(const Share& watches) : watches_("health watches at once", watches) {}

  /// A service is unknown until this was called for it.
  void set(const std::string& service, bool serving);
  /// Ends all watches, with kUnavailable, and begins no more.
  void end();
  std::vector<Reading> readings() const;

  grpc::ServerUnaryReactor* Check(grpc::CallbackServerContext* context,
                                  const Request* request,
                                  Response* response) override;
  grpc::ServerWriteReactor<Response>* Watch(grpc::CallbackServerContext* context,
                                            const Request* request) override;

 private:
  class Watcher;

  Response::ServingStatus status_of(const std::string& service) const;
  absl::Status admit(const std::shared_ptr<Watcher>& watcher, const std::string& client);
  void forget(const Watcher& watcher);

  mutable std::mutex mutex_;  ///< guards all below; never held while a watcher is told
  std::map<std::string, bool> services_;
  Tally watches_;
  struct Watched {
    std::weak_ptr<Watcher> watcher;
    std::string client;
  };
  std::map<const Watcher*, Watched> watchers_;
  bool ended_ = false;
  std::atomic<std::uint64_t> checks_{0}, refused_{0};
};

}  // namespace tet
