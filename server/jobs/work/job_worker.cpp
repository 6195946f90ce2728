#include "server/jobs/work/job_worker.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include <absl/time/clock.h>

#include "proto/convert/status.h"
#include "server/jobs/store/store_errors.h"
#include "server/ops/guard.h"
#include "server/ops/logging.h"
#include "server/rpc/background.h"

namespace tet {

namespace {

/// How long an idle worker does not look, though nobody told it of anything: shards that back
/// off become ready by themselves.
constexpr absl::Duration kPoll = absl::Seconds(1);

/// How soon a shard is stopped whose job was: so often a worker looks whether anything was
/// committed, and then at what it holds.
constexpr std::chrono::milliseconds kLook{500};

/// A store that does not answer is asked again after this.
constexpr absl::Duration kStorePause = absl::Milliseconds(500);

/// A thread that has found no room waits before it tries the next shard.
constexpr std::chrono::milliseconds kRoomPause{2000};

/// False when a stop is requested, then or before.
bool pause(const std::stop_token& stopping, std::chrono::milliseconds time) {
  std::mutex mutex;
  std::condition_variable_any never;
  std::unique_lock lock(mutex);
  return !never.wait_for(lock, stopping, time, [&] { return stopping.stop_requested(); });
}

void log_trouble(const char* event, const ShardKey& shard, const absl::Status& status) {
  nlohmann::ordered_json fields;
  fields["job"] = shard.job;
  fields["phase"] = static_cast<int>(shard.phase);
  fields["shard"] = shard.number;
  fields["reason"] = reason_of(status);
  fields["message"] = std::string(status.message());
  log_event(absl::IsDataLoss(status) ? spdlog::level::err : spdlog::level::warn, event, fields);
}

}  // namespace

JobWorker::JobWorker(JobStore& jobs, ShardMaker& maker, JobWorkerSettings settings)
    : jobs_(jobs), maker_(maker), settings_(std::move(settings)) {
  if (settings_.threads == 0) return;
  threads_.emplace_back([this](const std::stop_token& stopping) { claim_shards(stopping); });
  threads_.emplace_back([this](const std::stop_token& stopping) { beat(stopping); });
  for (int i = 0; i < settings_.threads; ++i) {
    threads_.emplace_back([this](const std::stop_token& stopping) { do_shards(stopping); });
  }
}

JobWorker::~JobWorker() { stop(); }

void JobWorker::stop() {
  giving_back_ = true;
  for (std::jthread& thread : threads_) thread.request_stop();
  for (const HeldShard& shard : held()) shard->watch->cancellation.cancel();
  threads_.clear();
  for (const HeldShard& shard : held()) jobs_.release(shard->lease.id).IgnoreError();
}

std::vector<JobWorker::HeldShard> JobWorker::held() {
  const std::lock_guard lock(mutex_);
  return {held_.begin(), held_.end()};
}

// One shard for each thread is claimed ahead, so that none waits for the store.
void JobWorker::claim_shards(const std::stop_token& stopping) {
  while (wait_for_room(stopping)) {
    const std::uint64_t seen = jobs_.signal();
    const auto claimed =
        guarded("a claim of shards", [&]() -> absl::StatusOr<bool> { return claim_some(); });
    if (!claimed.ok()) absl::SleepFor(kStorePause);
    if (claimed.ok() && !*claimed) jobs_.wait(seen, kPoll);
  }
}

bool JobWorker::wait_for_room(const std::stop_token& stopping) {
  std::unique_lock lock(mutex_);
  const auto room = static_cast<std::size_t>(2 * settings_.threads);
  return changed_.wait(lock, stopping, [&] { return held_.size() < room; }) &&
         !stopping.stop_requested();
}

/// False when there was nothing to claim.
bool JobWorker::claim_some() {
  std::int64_t room = 2 * settings_.threads;
  {
    const std::lock_guard lock(mutex_);
    room -= std::ssize(held_);
  }
  auto leases = jobs_.claim({settings_.name, room, settings_.lease});
  if (const bool failed = claims_fail_; (claims_fail_ = !leases.ok())) {
    if (!failed) log_trouble("claim_failed", {}, leases.status());
    absl::SleepFor(kStorePause);
    return false;
  }
  const std::lock_guard lock(mutex_);
  for (ShardLease& lease : *leases) {
    const auto shard = std::make_shared<Held>(std::move(lease));
    held_.insert(shard);
    waiting_.push_back(shard);
  }
  changed_.notify_all();
  return !leases->empty();
}

void JobWorker::do_shards(const std::stop_token& stopping) {
  give_way();
  while (true) {
    HeldShard shard;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, stopping, [&] { return !waiting_.empty(); });
      if (stopping.stop_requested()) return;
      shard = waiting_.front();
      waiting_.pop_front();
    }
    const absl::Status outcome =
        guarded("a shard", [&] { return maker_.run(shard->lease, shard->watch); });
    contain("the end of a shard", [&] { settle(shard, outcome, stopping); });
    let_go(shard);
    if (ShardMaker::lacks_room(outcome)) pause(stopping, kRoomPause);
  }
}

void JobWorker::let_go(const HeldShard& shard) {
  const std::lock_guard lock(mutex_);
  held_.erase(shard);
  changed_.notify_all();
}

/// Tells the store how a shard ended that it does not know of yet. A store that does not answer
/// now will find out that the lease is over.
void JobWorker::settle(const HeldShard& shard,
                       const absl::Status& outcome,
                       const std::stop_token& stopping) {
  const LeaseId& lease = shard->lease.id;
  if (outcome.ok()) {
    done_.fetch_add(1);
    return;
  }
  const bool stopped = shard->watch->cancellation.requested();
  if (stopped && giving_back_) {
    jobs_.release(lease).IgnoreError();
  } else if (stopped || reason_of(outcome) == "LEASE_LOST") {
    lost_.fetch_add(1);
    log_trouble("shard_lost", lease.shard, outcome);
  } else if (ShardMaker::lacks_room(outcome)) {
    log_trouble("shard_given_back", lease.shard, outcome);
    give_back(lease, stopping);
  } else {
    failed_.fetch_add(1);
    log_trouble("shard_failed", lease.shard, outcome);
    const absl::Status told =
        jobs_.fail(lease, outcome, ShardMaker::is_worth_another_try(outcome));
    if (!told.ok()) log_trouble("shard_lost", lease.shard, told);
  }
}

/// The shard is not to blame: no attempt of it is used up, however long the store is down too.
void JobWorker::give_back(const LeaseId& lease, const std::stop_token& stopping) {
  while (will_pass(jobs_.release(lease)) && !stopping.stop_requested()) {
    pause(stopping, absl::ToChronoMilliseconds(kStorePause));
  }
}

void JobWorker::beat(const std::stop_token& stopping) {
  using Clock = std::chrono::steady_clock;
  const auto interval = absl::ToChronoMilliseconds(settings_.lease / 3);
  auto due = Clock::now() + interval;
  std::uint64_t seen = jobs_.signal();
  while (pause(stopping, std::min(interval, kLook))) {
    const std::uint64_t signal = jobs_.signal();
    const bool is_due = Clock::now() >= due;
    if (is_due) due = Clock::now() + interval;
    contain("a worker's leases", [&] {
      if (is_due) {
        extend_leases();
      } else if (signal != seen) {
        look_at_leases();
      }
    });
    seen = signal;
  }
}

void JobWorker::extend_leases() {
  const std::vector<HeldShard> shards = held();
  if (!shards.empty()) heed(shards, jobs_.heartbeat(ids_of(shards), settings_.lease));
}

/// Something was committed by somebody: a job of ours may have been cancelled.
void JobWorker::look_at_leases() {
  const std::vector<HeldShard> shards = held();
  if (!shards.empty()) heed(shards, jobs_.look_at(ids_of(shards)));
}

/// What is lost is not worth going on with.
void JobWorker::heed(const std::vector<HeldShard>& shards,
                     const absl::StatusOr<std::vector<LeaseState>>& answers) {
  if (!answers.ok()) return log_trouble("heartbeat_failed", {}, answers.status());
  for (std::size_t i = 0; i < shards.size(); ++i) {
    if ((*answers)[i] == LeaseState::kLost) shards[i]->watch->cancellation.cancel();
  }
}

std::vector<LeaseId> JobWorker::ids_of(const std::vector<HeldShard>& shards) {
  std::vector<LeaseId> ids;
  for (const HeldShard& shard : shards) ids.push_back(shard->lease.id);
  return ids;
}

}  // namespace tet
