// Whether jobs can be taken and done now: their database and the disk of their results.
#pragma once

#include <mutex>

#include <absl/status/status.h>
#include <absl/time/time.h>

#include "server/jobs/results/result_store.h"
#include "server/jobs/store/job_store.h"
#include "server/rpc/heartbeat.h"

namespace tet {

/// Writes a little to both every now and then, and soon again while that fails; logs when it
/// begins to fail and when it works again. Thread-safe.
class JobHealth {
 public:
  /// Both references must outlive it.
  JobHealth(JobStore& jobs, const ResultStore& results);

  /// How writing went the last time. Errors: those of JobStore::probe and ResultStore::probe.
  absl::Status status() const;

 private:
  void look();
  bool is_due() const;
  void learn(const absl::Status& found);

  JobStore& jobs_;
  const ResultStore& results_;
  mutable std::mutex mutex_;
  absl::Status status_;
  absl::Time looked_ = absl::InfinitePast();
  Heartbeat heartbeat_;  // last: it uses all of the above
};

}  // namespace tet
