// Whether jobs can be taken and done now: their database and the disk of their results.
#pragma once

#include <chrono>
#include <mutex>

#include <absl/status/status.h>

#include "server/jobs/store/job_store.h"
#include "server/jobs/work/work_place.h"
#include "server/rpc/heartbeat.h"

namespace tet {

/// Writes a little to both every now and then, and soon again while that fails; logs when it
/// begins to fail and when it works again. Thread-safe.
class JobHealth {
 public:
  /// Both references must outlive it.
  JobHealth(JobStore& jobs, WorkPlace& place);

  /// How writing went the last time. Errors: those of JobStore::probe and WorkPlace::check.
  absl::Status status() const;

 private:
  void look();
  bool is_due() const;
  void learn(const absl::Status& found);

  JobStore& jobs_;
  WorkPlace& place_;
  mutable std::mutex mutex_;
  absl::Status status_;
  std::chrono::steady_clock::time_point looked_{};
  Heartbeat heartbeat_;  // last: it uses all of the above
};

}  // namespace tet
