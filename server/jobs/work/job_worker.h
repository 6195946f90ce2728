// Threads that do jobs' shards: claim, do, commit, and give back when they are stopped.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <absl/time/time.h>

#include "server/jobs/store/job_store.h"
#include "server/jobs/work/quarantine.h"
#include "server/jobs/work/shard_maker.h"
#include "server/jobs/work/work_place.h"

namespace tet {

struct JobWorkerSettings {
  std::string name;  ///< in the job store, for people; 1 to 128 bytes
  int threads = 1;   ///< shards done at once, and one more of a namespace that would have none
  absl::Duration lease = absl::Seconds(30);
};

/// Works from its construction to `stop`. What it does not hold any more, of a job that was
/// cancelled for instance, it stops within half a second or so of hearing of it.
/// The threads have a lower priority than any other of
/// the process, so that whoever waits for a mesh gets the cores first.
///
/// One namespace never has all there is, so that shards which take minutes do not keep those of
/// another waiting: it has no more than `threads` at once, and one that has none under way gets
/// the thread beyond them, even where all that may be claimed ahead is claimed.
///
/// A worker that cannot work does no harm: what failed for a reason of its own it gives back
/// without using up an attempt, and it claims nothing until the place it works in is right
/// again, for longer each time.
class JobWorker {
 public:
  JobWorker(JobStore& jobs,
            ShardMaker& maker,
            WorkPlace& place,
            const ResultStore& results,
            JobWorkerSettings settings);
  ~JobWorker();

  /// Gives back what is claimed and not done; returns when no thread runs any more.
  void stop();

  /// Since the start.
  std::int64_t done_shards() const { return done_.load(); }
  std::int64_t failed_shards() const { return failed_.load(); }
  std::int64_t lost_shards() const { return lost_.load(); }
  std::int64_t given_back_shards() const { return given_back_.load(); }
  /// Those of them that wait for room among the results.
  std::int64_t no_room_shards() const { return no_room_.load(); }
  std::int64_t quarantines() const { return quarantine_.count(); }
  /// Why it takes nothing at present; OK while it does.
  absl::Status trouble() const { return quarantine_.trouble(); }

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
  bool is_fit(const std::stop_token& stopping);
  void keep_hands_off(const absl::Status& why);
  bool claim_some();
  ClaimShards next_claim();
  std::deque<HeldShard>::iterator next_waiting();
  void do_shards(const std::stop_token& stopping);
  absl::Status run(const Held& shard);
  void settle(const HeldShard& shard,
              const absl::Status& outcome,
              const std::stop_token& stopping);
  absl::Status own_trouble(const HeldShard& shard, const absl::Status& outcome);
  void give_back(const LeaseId& lease, const GiveBack& how, const std::stop_token& stopping);
  void give_back_waiting(const absl::Status& why, const std::stop_token& stopping);
  absl::Status in_our_name(const absl::Status& why) const;
  void let_go(const HeldShard& shard);
  void beat(const std::stop_token& stopping);
  void report();
  void extend_leases();
  void look_at_leases();
  static void heed(const std::vector<HeldShard>& shards,
                   const absl::StatusOr<std::vector<LeaseState>>& answers);
  static std::vector<LeaseId> ids_of(const std::vector<HeldShard>& shards);
  std::vector<HeldShard> held();

  JobStore& jobs_;
  ShardMaker& maker_;
  WorkPlace& place_;
  const ResultStore& results_;
  const JobWorkerSettings settings_;
  std::atomic<std::int64_t> done_{0}, failed_{0}, lost_{0}, given_back_{0}, no_room_{0};
  Quarantine quarantine_;
  std::atomic<bool> giving_back_{false};
  // These belong to the thread that claims: whether that was logged, and when it looked.
  bool claims_fail_ = false;
  std::chrono::steady_clock::time_point looked_{};

  std::mutex mutex_;  ///< guards what follows
  std::condition_variable_any changed_;
  std::deque<HeldShard> waiting_;       ///< claimed, and not begun
  std::set<HeldShard> held_;            ///< claimed, and not settled
  std::map<std::string, int> running_;  ///< shards under way of each namespace that has any
  std::set<std::string> excused_;  ///< jobs that met a failing disk of ours, and lost nothing

  std::vector<std::jthread> threads_;  // last: they use all of the above
};

}  // namespace tet
