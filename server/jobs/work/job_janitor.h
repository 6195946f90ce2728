// Clears away what is over: leases, jobs whose time is up, jobs long finished, results over the
// budget.
#pragma once

#include <atomic>
#include <cstdint>

#include <absl/status/statusor.h>
#include <absl/time/time.h>

#include "server/jobs/results/result_store.h"
#include "server/jobs/store/job_store.h"
#include "server/rpc/heartbeat.h"

namespace tet {

/// Any number of processes may have one for the same store. The store and the results outlive
/// it.
class JobJanitor {
 public:
  /// Jobs that have been finished for `keep` are forgotten. Workers whose leases last as long
  /// as `lease` are given so much time to be heard of again after the store did not answer.
  JobJanitor(JobStore& jobs, ResultStore& results, absl::Duration keep, absl::Duration lease);

 private:
  void look_after_jobs();
  void tell(const char* event, const absl::StatusOr<std::int64_t>& count);
  void tidy_up();

  JobStore& jobs_;
  ResultStore& results_;
  const absl::Duration keep_, lease_;
  absl::Time rescue_from_ = absl::InfinitePast();  ///< of the thread that looks often
  std::atomic<bool> failing_{false};               ///< and that was logged
  Heartbeat often_, seldom_;
};

}  // namespace tet
