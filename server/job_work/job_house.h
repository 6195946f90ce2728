// Keeps the house of jobs: leases that are over, jobs whose time is up, jobs long finished,
// results over the budget.
#pragma once

#include <absl/time/time.h>

#include "server/heartbeat.h"
#include "server/jobs/job_store.h"
#include "server/results/result_store.h"

namespace tet {

/// Any number of processes may keep one house. Both outlive it.
class JobHouse {
 public:
  /// Jobs that have been finished for `keep` are forgotten.
  JobHouse(JobStore& jobs, ResultStore& results, absl::Duration keep);

 private:
  void look_after_jobs();
  void tidy_up();

  JobStore& jobs_;
  ResultStore& results_;
  const absl::Duration keep_;
  Heartbeat often_, seldom_;
};

}  // namespace tet
