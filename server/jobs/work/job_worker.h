// Threads that do jobs' shards: claim, do, commit, and give back when they are stopped.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <absl/time/time.h>

#include "server/jobs/store/job_store.h"
#include "server/jobs/work/shard_maker.h"

namespace tet {

struct JobWorkerSettings {
  std::string name;  ///< in the job store, for people; 1 to 128 bytes
  int threads = 1;   ///< shards done at once
  absl::Duration lease = absl::Seconds(30);
};

/// Works from its construction to `stop`. What it does not hold any more, of a job that was
/// cancelled for instance, it stops within half a second or so of hearing of it.
/// The threads have a lower priority than any other of
/// the process, so that whoever waits for a mesh gets the cores first.
class JobWorker {
 public:
  JobWorker(JobStore& jobs, ShardMaker& maker, JobWorkerSettings settings);
  ~JobWorker();

  /// Gives back what is claimed and not done; returns when no thread runs any more.
  void stop();

  /// Since the start.
  std::int64_t done_shards() const { return done_.load(); }
  std::int64_t failed_shards() const { return failed_.load(); }
  std::int64_t lost_shards() const { return lost_.load(); }

 private:
  struct Held {
    explicit Held(ShardLease claimed) : lease(std::move(claimed)) {}
    ShardLease lease;
    const std::shared_ptr<PlanningWatch> watch =
        std::make_shared<PlanningWatch>(Cancellation::Clock::time_point::max());
  };
  using HeldShard = std::shared_ptr<Held>;

  void claim_shards(const std::stop_token& stopping);
  bool wait_for_room(const std::stop_token& stopping);
  bool claim_some();
  void do_shards(const std::stop_token& stopping);
  void settle(const HeldShard& shard,
              const absl::Status& outcome,
              const std::stop_token& stopping);
  void give_back(const LeaseId& lease, const std::stop_token& stopping);
  void let_go(const HeldShard& shard);
  void beat(const std::stop_token& stopping);
  void extend_leases();
  void look_at_leases();
  static void heed(const std::vector<HeldShard>& shards,
                   const absl::StatusOr<std::vector<LeaseState>>& answers);
  static std::vector<LeaseId> ids_of(const std::vector<HeldShard>& shards);
  std::vector<HeldShard> held();

  JobStore& jobs_;
  ShardMaker& maker_;
  const JobWorkerSettings settings_;
  std::atomic<std::int64_t> done_{0}, failed_{0}, lost_{0};
  std::atomic<bool> giving_back_{false};
  bool claims_fail_ = false;  ///< and that was logged; of the thread that claims

  std::mutex mutex_;  ///< guards what follows
  std::condition_variable_any changed_;
  std::deque<HeldShard> waiting_;  ///< claimed, and not begun
  std::set<HeldShard> held_;       ///< claimed, and not settled

  std::vector<std::jthread> threads_;  // last: they use all of the above
};

}  // namespace tet
