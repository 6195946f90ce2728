// Clears away what is over: leases, jobs whose time is up, jobs long finished, results over the
// budget.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>

#include <absl/status/statusor.h>
#include <absl/time/time.h>

#include "server/jobs/results/result_store.h"
#include "server/jobs/store/job_store.h"
#include "server/jobs/work/clock_watch.h"
#include "server/rpc/heartbeat.h"

namespace tet {

/// Any number of processes may have one for the same store. The store and the results outlive
/// it.
class JobJanitor {
 public:
  /// Jobs that have been finished for `keep` are forgotten. Workers whose leases last as long
  /// as `lease` are given so much time to be heard of again after the store did not answer.
  JobJanitor(JobStore& jobs, ResultStore& results, absl::Duration keep, absl::Duration lease);

  /// How far this machine's clock is ahead of the store's, in seconds; 0 while that is not
  /// known.
  double clock_ahead_seconds() const { return clock_ahead_.load(); }

 private:
  using Clock = ClockWatch::Steady;

  void look_after_jobs();
  bool look_at_clocks();
  void tell_clocks(const ClockWatch::Finding& found);
  void tell(const char* event, const absl::StatusOr<std::int64_t>& count);
  void tidy_up();
  void hold(Clock::duration time);

  JobStore& jobs_;
  ResultStore& results_;
  const absl::Duration keep_, lease_;
  std::atomic<double> clock_ahead_{0};
  std::atomic<Clock::time_point> act_from_{Clock::time_point::min()};  ///< nothing ends before
  std::atomic<bool> failing_{false};                                   ///< and that was logged
  // These belong to the thread that looks often.
  bool differs_ = false;  ///< and that was logged
  ClockWatch clocks_;
  // This belongs to the thread that looks seldom.
  Clock::time_point tidy_from_ = Clock::time_point::min();
  Heartbeat often_, seldom_;
};

}  // namespace tet
