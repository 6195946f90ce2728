// `tetstreamd worker`: a process that does jobs for the servers whose store it shares.
#pragma once

#include <memory>

#include <absl/status/statusor.h>

#include "server/ops/config.h"

namespace tet {

/// Works from `start` to its destruction, which gives back what is not done.
class WorkerProcess {
 public:
  /// Errors: those of GridStore::open_beside_server, open_job_store, ResultStore::open and
  /// MetricsPort::open; kInvalidArgument (no threads, or jobs are off).
  static absl::StatusOr<std::unique_ptr<WorkerProcess>> start(const Config& config);
  ~WorkerProcess();

  /// Whether for `job_idle_seconds` no shard was left to do, by anybody; never if that is 0.
  /// It looks when it is asked: about once a second.
  bool is_idle();
  /// host:port of the metrics; empty if there are none.
  std::string metrics_address() const;

 private:
  struct Parts;
  explicit WorkerProcess(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace tet
