#include "server/jobs/work/job_worker.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include <absl/strings/str_cat.h>
#include <absl/time/clock.h>

#include "core/base/parallel.h"
#include "core/plan/mesh_request.h"
#include "proto/convert/status.h"
#include "server/jobs/results/needed_meshes.h"
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

/// What found no room is left to others for so long, and then longer, who may have smaller
/// meshes.
constexpr absl::Duration kRoomPause = absl::Seconds(2);

/// A worker that has something to do looks so often whether it is still the right place.
constexpr std::chrono::seconds kBetweenPlaceLooks{5};

/// So often a worker is heard of, or as often as its leases are: well within kWorkerAlive.
constexpr std::chrono::milliseconds kBetweenReports{10'000};

/// Jobs whose first failing disk is remembered; then it begins anew.
constexpr std::size_t kMostExcused = 10'000;

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

JobWorker::JobWorker(JobStore& jobs,
                     ShardMaker& maker,
                     WorkPlace& place,
                     const ResultStore& results,
                     JobWorkerSettings settings)
    : jobs_(jobs),
      maker_(maker),
      place_(place),
      results_(results),
      settings_(std::move(settings)) {
  if (settings_.threads == 0) return;
  keep_priority_of_pools();  // shards have plans made on the pools that serve streams
  threads_.emplace_back([this](const std::stop_token& stopping) { claim_shards(stopping); });
  threads_.emplace_back([this](const std::stop_token& stopping) { beat(stopping); });
  for (int i = 0; i < settings_.threads + 1; ++i) {
    threads_.emplace_back([this](const std::stop_token& stopping) { do_shards(stopping); });
  }
}

JobWorker::~JobWorker() { stop(); }

void JobWorker::stop() {
  giving_back_ = true;
  for (std::jthread& thread : threads_) thread.request_stop();
  jobs_.wake_all();
  for (const HeldShard& shard : held()) shard->watch->cancellation.cancel();
  threads_.clear();
  for (const HeldShard& shard : held()) jobs_.release(shard->lease.id).IgnoreError();
  if (settings_.threads > 0) jobs_.leave(settings_.name).IgnoreError();
}

std::vector<JobWorker::HeldShard> JobWorker::held() {
  const std::lock_guard lock(mutex_);
  return {held_.begin(), held_.end()};
}

// One shard for each thread is claimed ahead, so that none waits for the store; and one more of
// a namespace of which none was.
void JobWorker::claim_shards(const std::stop_token& stopping) {
  report();
  while (wait_for_room(stopping)) {
    const std::uint64_t seen = jobs_.signal();
    if (!is_fit(stopping)) continue;
    const auto claimed =
        guarded("a claim of shards", [&]() -> absl::StatusOr<bool> { return claim_some(); });
    if (!claimed.ok()) absl::SleepFor(kStorePause);
    // What woke before `seen` was read had asked to stop before that.
    if (claimed.ok() && !*claimed && !stopping.stop_requested()) jobs_.wait(seen, kPoll);
  }
}

bool JobWorker::wait_for_room(const std::stop_token& stopping) {
  std::unique_lock lock(mutex_);
  const auto room = static_cast<std::size_t>(2 * settings_.threads + 1);
  return changed_.wait(lock, stopping, [&] { return held_.size() < room; }) &&
         !stopping.stop_requested();
}

/// Whether anything may be claimed: looks now and then, and after each pause in quarantine.
bool JobWorker::is_fit(const std::stop_token& stopping) {
  using Clock = std::chrono::steady_clock;
  const bool in_trouble = !quarantine_.trouble().ok();
  if (in_trouble && !pause(stopping, absl::ToChronoMilliseconds(quarantine_.pause()))) {
    return false;
  }
  if (!in_trouble && Clock::now() < looked_ + kBetweenPlaceLooks) return true;
  looked_ = Clock::now();
  const absl::Status found =
      guarded("a worker's look at its place", [&] { return place_.check(results_); });
  if (will_pass(found)) return true;  // whoever claims finds out, and waits
  if (!found.ok()) {
    keep_hands_off(found);
    return false;
  }
  if (quarantine_.leave()) {
    log_event(spdlog::level::info, "worker_back");
    report();
  }
  return true;
}

void JobWorker::keep_hands_off(const absl::Status& why) {
  if (!quarantine_.enter(why)) return;
  log_event(spdlog::level::err, "worker_quarantined",
            {{"reason", reason_of(why)}, {"message", std::string(why.message())}});
  report();
}

/// The next of our version may have to go on with jobs that nobody else can.
void JobWorker::report() {
  contain("a worker's report", [&] {
    const absl::Status trouble = quarantine_.trouble();
    jobs_.report({settings_.name, kAlgorithmVersion, trouble}).IgnoreError();
    if (!trouble.ok()) return;
    const auto replanned = jobs_.replan(kAlgorithmVersion);
    if (!replanned.ok() || *replanned == 0) return;
    log_event(spdlog::level::warn, "jobs_replanned",
              {{"count", *replanned}, {"algorithm", kAlgorithmVersion}});
  });
}

ClaimShards JobWorker::next_claim() {
  const std::lock_guard lock(mutex_);
  const std::int64_t room = 2 * settings_.threads - std::ssize(held_);
  ClaimShards claim{settings_.name, std::max<std::int64_t>(room, 1), settings_.lease,
                    kAlgorithmVersion};
  if (room > 0) return claim;
  for (const HeldShard& shard : held_) claim.not_of.insert(shard->lease.space);
  return claim;
}

/// False when there was nothing to claim.
bool JobWorker::claim_some() {
  auto leases = jobs_.claim(next_claim());
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

/// The first shard that may begin; with the lock.
std::deque<JobWorker::HeldShard>::iterator JobWorker::next_waiting() {
  int all = 0;
  for (const auto& [space, count] : running_) all += count;
  return std::ranges::find_if(waiting_, [&](const HeldShard& shard) {
    const auto own = running_.find(shard->lease.space);
    return own == running_.end() || all < settings_.threads;
  });
}

void JobWorker::do_shards(const std::stop_token& stopping) {
  give_way();
  while (true) {
    HeldShard shard;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, stopping, [&] { return next_waiting() != waiting_.end(); });
      if (stopping.stop_requested()) return;
      const auto next = next_waiting();
      shard = *next;
      waiting_.erase(next);
      ++running_[shard->lease.space];
    }
    const absl::Status outcome = guarded("a shard", [&] { return run(*shard); });
    contain("the end of a shard", [&] { settle(shard, outcome, stopping); });
    {
      const std::lock_guard lock(mutex_);
      const auto own = running_.find(shard->lease.space);
      if (--own->second == 0) running_.erase(own);
    }
    let_go(shard);
  }
}

void JobWorker::let_go(const HeldShard& shard) {
  const std::lock_guard lock(mutex_);
  held_.erase(shard);
  changed_.notify_all();
}

/// Where the store was away at the moment that a grid was opened, it may be back before anybody
/// looks: so what the right store does not have is looked for again.
absl::Status JobWorker::run(const Held& shard) {
  const absl::Status outcome = maker_.run(shard.lease, shard.watch);
  if (reason_of(outcome) != "GRID_NOT_FOUND") return outcome;
  const absl::Status place = place_.check_store();
  return place.ok() ? maker_.run(shard.lease, shard.watch) : place;
}

/// Tells the store how a shard ended that it does not know of yet. A store that does not answer
/// now will find out that the lease is over.
void JobWorker::settle(const HeldShard& shard,
                       const absl::Status& outcome,
                       const std::stop_token& stopping) {
  const LeaseId& lease = shard->lease.id;
  if (outcome.ok()) {
    done_.fetch_add(1);
    quarantine_.worked();
    return;
  }
  const bool stopped = shard->watch->cancellation.requested();
  if (stopped && giving_back_) {
    jobs_.release(lease).IgnoreError();
  } else if (stopped || reason_of(outcome) == "LEASE_LOST") {
    lost_.fetch_add(1);
    log_trouble("shard_lost", lease.shard, outcome);
  } else if (const absl::Status own = own_trouble(shard, outcome); !own.ok()) {
    log_trouble("shard_given_back", lease.shard, own);
    // A store that does not answer is everybody's trouble, and want of room the mesh's own.
    const bool awaits = ShardMaker::awaits_room(own);
    if (awaits) no_room_.fetch_add(1);
    const bool ours = !will_pass(own) && !awaits;
    if (ours) keep_hands_off(own);
    const bool no_room = ShardMaker::lacks_room(own);
    give_back(
        lease,
        {in_our_name(own), no_room ? kRoomPause : absl::ZeroDuration(), is_want_of_room(own)},
        stopping);
    if (ours) give_back_waiting(own, stopping);
  } else {
    failed_.fetch_add(1);
    log_trouble("shard_failed", lease.shard, outcome);
    const absl::Status told =
        ShardMaker::ends_job(outcome)
            ? jobs_.fail_job(lease, outcome)
            : jobs_.fail(lease, outcome, ShardMaker::is_worth_another_try(outcome));
    if (!told.ok()) log_trouble("shard_lost", lease.shard, told);
  }
}

/// Why it is not the shard's fault that it failed; OK if that cannot be said. A file that is
/// not there, or cannot be read, may be the job's trouble or ours: the store tells. A disk that
/// fails though the store looks right is ours once a job; then it may be the job's file.
absl::Status JobWorker::own_trouble(const HeldShard& shard, const absl::Status& outcome) {
  if (ShardMaker::lacks_room(outcome)) return outcome;
  const std::string reason = reason_of(outcome);
  if (reason == "DECODER_UNAVAILABLE" || reason == "WRONG_STORE") return outcome;
  const bool of_disk = reason == "DISK" || reason == "STORED_GRID_CORRUPT";
  if (!of_disk && reason != "GRID_NOT_FOUND") return absl::OkStatus();
  const absl::Status place = place_.check_store();
  if (!place.ok()) return place;
  if (reason != "DISK") return absl::OkStatus();
  const std::lock_guard lock(mutex_);
  if (excused_.size() >= kMostExcused) excused_.clear();
  return excused_.insert(shard->lease.id.shard.job).second ? outcome : absl::OkStatus();
}

/// What the job tells of us.
absl::Status JobWorker::in_our_name(const absl::Status& why) const {
  absl::Status named(why.code(), absl::StrCat("worker ", settings_.name, ": ", why.message()));
  why.ForEachPayload([&](absl::string_view type, const absl::Cord& payload) {
    named.SetPayload(type, payload);
  });
  return named;
}

/// The shard is not to blame: no attempt of it is used up, however long the store is down too.
void JobWorker::give_back(const LeaseId& lease,
                          const GiveBack& how,
                          const std::stop_token& stopping) {
  given_back_.fetch_add(1);
  while (will_pass(jobs_.release(lease, how)) && !stopping.stop_requested()) {
    pause(stopping, absl::ToChronoMilliseconds(kStorePause));
  }
}

/// What was claimed ahead would only fail likewise.
void JobWorker::give_back_waiting(const absl::Status& why, const std::stop_token& stopping) {
  std::deque<HeldShard> waiting;
  {
    const std::lock_guard lock(mutex_);
    waiting.swap(waiting_);
  }
  // What found no room has said so of its own job. These were not tried: nothing is said of
  // theirs, and others have a turn before them, too.
  const GiveBack untried = is_want_of_room(why) ? GiveBack{absl::OkStatus(), kRoomPause}
                                                : GiveBack{in_our_name(why)};
  for (const HeldShard& shard : waiting) {
    give_back(shard->lease.id, untried, stopping);
    let_go(shard);
  }
}

void JobWorker::beat(const std::stop_token& stopping) {
  using Clock = std::chrono::steady_clock;
  const auto interval = absl::ToChronoMilliseconds(settings_.lease / 3);
  auto due = Clock::now() + interval;
  const auto between_reports = std::min(interval, kBetweenReports);
  auto report_due = Clock::now() + between_reports;
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
    if (Clock::now() < report_due) continue;
    report_due = Clock::now() + between_reports;
    report();
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
  ids.reserve(shards.size());
  for (const HeldShard& shard : shards) ids.push_back(shard->lease.id);
  return ids;
}

}  // namespace tet
