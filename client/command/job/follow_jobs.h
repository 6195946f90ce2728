// Jobs until they are finished.
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include <absl/status/status.h>

#include "client/library/job_client.h"
#include "core/base/cancel.h"
#include "core/base/on_cancel.h"

namespace tet {

/// Who is told of jobs that are followed.
struct FollowWatch {
  /// A job is in a final state, as the server gave it after that; or it was deleted meanwhile,
  /// then only its name is set.
  std::function<void(const v1::Job&)> finished;
  /// How many of all jobs are done: those finished, and the finished parts of those that run.
  std::function<void(double jobs)> progress;
};

/// Returns when every job is finished. Watches all changes rather than ask for each job again
/// and again, so that thousands cost no more than one. Errors: the server's.
absl::Status follow_jobs(JobClient& client,
                         const std::vector<std::string>& names,
                         const FollowWatch& watch,
                         const Cancellation& cancellation);

/// Cancelled when another cancellation is, or after a time.
class Patience {
 public:
  Patience(const Cancellation& interruption, std::chrono::nanoseconds time);

  const Cancellation& cancellation() const { return cancellation_; }

 private:
  Cancellation cancellation_;
  const OnCancel on_interruption_;  // last: it uses the other
};

}  // namespace tet
