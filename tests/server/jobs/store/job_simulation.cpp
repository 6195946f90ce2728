#include "tests/server/jobs/store/job_simulation.h"

#include <algorithm>
#include <deque>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include <absl/strings/str_cat.h>
#include <absl/time/time.h>

#include "server/jobs/store/sqlite_job_store.h"
#include "tests/server/jobs/store/made_up_work.h"

namespace tet::test {
namespace {

constexpr absl::Duration kLease = absl::Seconds(10);

struct Worker {
  std::string name;
  std::vector<ShardLease> leases;
  absl::Time away_until =
      absl::InfinitePast();  ///< paused: it knows nothing of the time that passed
};

class Simulation {
 public:
  explicit Simulation(std::uint64_t seed) : random_(seed) {
    SqliteOptions options{.path = ":memory:", .clock = [this] { return now_; }};
    store_ = open_sqlite_job_store(options).value();
    for (int i = 0; i < 3; ++i) workers_.push_back({absl::StrCat("w", i), {}, now_});
  }

  Simulated play(int steps) {
    for (int i = 0; i < steps && ok(); ++i) step();
    for (int i = 0; i < 2000 && ok() && !finished(); ++i) honest_step();
    if (ok()) check_jobs();
    if (ok()) check_events();
    return std::move(result_);
  }

 private:
  bool ok() const { return result_.violation.empty(); }
  int roll(int sides) { return static_cast<int>(random_() % static_cast<unsigned>(sides)); }
  bool chance(int percent) { return roll(100) < percent; }

  void violate(const std::string& what) {
    if (ok()) result_.violation = what;
  }
  void note(std::uint64_t what) {
    result_.trace = (result_.trace ^ what) * 0x100000001b3;  // FNV-1a's prime
  }
  std::uint64_t number_of_job(const std::string& id) {
    return static_cast<std::uint64_t>(std::ranges::find(acknowledged_, id) -
                                      acknowledged_.begin());
  }

  void pass(absl::Duration most) {
    now_ += absl::Microseconds(1) + most * (roll(1000) / 1000.0);
    note(static_cast<std::uint64_t>(absl::ToUnixMicros(now_)));
  }

  void step() {
    pass(absl::Seconds(2));
    Worker& worker = workers_[static_cast<std::size_t>(roll(3))];
    const int what = roll(100);
    if (what < 15) return submit();
    if (what < 18) return cancel();
    if (what < 20) return retry();
    if (what < 28) return (void)store_->rescue().value();
    if (what < 30) return (void)store_->expire().value();
    if (worker.away_until > now_) return;
    if (what < 55) return claim(worker);
    if (what < 85) return end_one(worker);
    if (what < 94) return heartbeat(worker);
    if (what < 97) return crash(worker);
    worker.away_until = now_ + kLease * (roll(30) / 10.0);
  }

  /// No accidents any more: what is there comes to its end.
  void honest_step() {
    now_ += absl::Seconds(3);
    store_->rescue().value();
    store_->expire().value();
    for (Worker& worker : workers_) {
      claim(worker);
      while (!worker.leases.empty() && ok()) commit(worker);
    }
  }

  void submit() {
    // A client that got no answer asks again, with the same request id.
    if (unanswered_.empty() || chance(50)) {
      NewJob job;
      job.space = chance(50) ? "ana" : "bob";
      job.request_id = absl::StrCat(++requests_);
      job.priority = roll(3);
      job.max_attempts = 1 + roll(3);
      if (chance(10)) job.ttl = absl::Seconds(20 + roll(40));
      if (chance(10)) job.timeout = absl::Seconds(20 + roll(40));
      unanswered_.push_back(job);
    }
    const NewJob job = unanswered_.front();
    unanswered_.pop_front();
    const CreatedJob created = store_->create(job).value();
    const auto [known, first] = made_.emplace(job.request_id, created.job.id);
    if (known->second != created.job.id) violate("one request made two jobs");
    if (created.existed == first)
      violate("a job was made again, or was there before it was made");
    if (first) acknowledged_.push_back(created.job.id);
    if (chance(20)) unanswered_.push_back(job);
    note(number_of_job(created.job.id));
  }

  std::string any_job() {
    return acknowledged_.empty() ? ""
                                 : acknowledged_[static_cast<std::size_t>(
                                       roll(static_cast<int>(acknowledged_.size())))];
  }

  void cancel() {
    const std::string id = any_job();
    if (id.empty()) return;
    if (store_->cancel(id).value().state == JobState::kCancelled) cancelled_.insert(id);
  }

  void retry() {
    const std::string id = any_job();
    if (!id.empty() && store_->retry(id).ok()) cancelled_.erase(id);
  }

  void claim(Worker& worker) {
    const auto leases = store_->claim({worker.name, 1 + roll(3), kLease}).value();
    for (const ShardLease& lease : leases) {
      std::int64_t& last = last_token_[lease.id.shard];
      if (lease.id.token <= last) violate("a token did not grow");
      last = lease.id.token;
      worker.leases.push_back(lease);
      note(number_of_job(lease.id.shard.job) << 32 |
           static_cast<std::uint64_t>(lease.id.shard.number));
    }
  }

  void end_one(Worker& worker) {
    if (worker.leases.empty()) return;
    const ShardLease lease = worker.leases.front();
    if (chance(75)) return commit(worker);
    worker.leases.erase(worker.leases.begin());
    const absl::Status status =
        chance(15) ? store_->release(lease.id)
                   : store_->fail(lease.id, absl::InternalError("bad luck"), chance(80));
    if (!status.ok() && !absl::IsAborted(status)) violate(status.ToString());
  }

  void commit(Worker& worker) {
    const ShardLease lease = worker.leases.front();
    const ShardKey& shard = lease.id.shard;
    const bool cancelled = cancelled_.contains(shard.job);
    const absl::Status status =
        shard.phase == Phase::kPlan
            ? store_->set_plan(lease.id,
                               plan_of(static_cast<std::int64_t>(lease.id.token % 4), 2))
            : store_->complete(lease.id, digests_of(lease.chunks));
    note(static_cast<std::uint64_t>(status.code()));
    // The acknowledgement is lost: the worker will try again, and must then be told the same.
    if (!chance(10) || !status.ok()) worker.leases.erase(worker.leases.begin());
    if (absl::IsAborted(status)) {
      ++result_.lost_leases;
      if (committed_[shard] == lease.id.token) violate("a commit was taken back");
    } else if (!status.ok()) {
      violate(status.ToString());
    } else {
      committed(lease, cancelled);
    }
  }

  void committed(const ShardLease& lease, bool cancelled) {
    std::int64_t& token = committed_[lease.id.shard];
    if (token == lease.id.token) return;  // a repetition
    if (token != 0) violate("a shard was committed twice");
    if (last_token_[lease.id.shard] != lease.id.token) violate("a stale lease committed");
    if (cancelled) violate("a cancelled job went on");
    token = lease.id.token;
    ++result_.commits;
  }

  void heartbeat(Worker& worker) {
    std::vector<LeaseId> ids;
    for (const ShardLease& lease : worker.leases) ids.push_back(lease.id);
    const auto answers = store_->heartbeat(ids, kLease).value();
    std::vector<ShardLease> held;
    for (std::size_t i = 0; i < ids.size(); ++i) {
      const bool latest = last_token_[ids[i].shard] == ids[i].token;
      if (answers[i] == LeaseState::kHeld && !latest) violate("a stale lease was extended");
      // A worker that does not listen goes on with what it lost.
      if (answers[i] == LeaseState::kHeld || chance(50)) held.push_back(worker.leases[i]);
    }
    worker.leases = std::move(held);
  }

  void crash(Worker& worker) {
    worker.leases.clear();
    ++result_.crashes;
  }

  bool finished() {
    return std::ranges::all_of(acknowledged_, [&](const std::string& id) {
      const auto job = store_->get(id);
      return job.ok() && is_finished(job->state);
    });
  }

  void check_jobs() {
    for (const std::string& id : acknowledged_) {
      const auto job = store_->get(id);
      if (!job.ok()) return violate("an acknowledged job is lost");
      if (!is_finished(job->state)) return violate("a job came to no end");
      ++result_.finished;
      const auto letters = store_->dead_letters(id).value();
      result_.dead += static_cast<int>(letters.size());
      if (std::ssize(letters) != job->dead_shards) violate("dead letters are missing");
      if (job->done_shards + job->dead_shards != job->shard_count)
        violate("shards are missing");
      if (job->alarms != 0) violate("a false alarm");
      if (job->state == JobState::kSucceeded) {
        check_result(*job);
      } else if (job->error.ok() || letters.empty()) {
        violate("a job does not say why it failed");
      }
    }
  }

  void check_result(const Job& job) {
    const auto digests = store_->chunk_digests(job.id, {0, job.chunk_count}).value();
    if (std::ssize(digests) != job.chunk_count) violate("a result has holes");
    if (job.dead_shards != 0 || !job.error.ok()) violate("a job succeeded with an error");
  }

  void check_events() {
    std::map<std::string, JobEvent> last;
    std::int64_t revision = 0;
    while (true) {
      const auto page =
          store_->watch({.after_revision = revision, .limit = 1 + roll(50)}).value();
      if (page.events.empty()) break;
      for (const JobEvent& event : page.events) {
        if (event.revision <= revision) violate("revisions went back");
        if (event.version != last[event.job].version + 1)
          violate("a version was missed or repeated");
        revision = event.revision;
        last[event.job] = event;
      }
    }
    for (const std::string& id : acknowledged_) {
      const Job job = store_->get(id).value();
      if (last[id].state != job.state || last[id].version != job.version) {
        violate("the events end elsewhere than the job");
      }
    }
  }

  std::mt19937_64 random_;
  absl::Time now_ = absl::FromUnixSeconds(1'700'000'000);
  std::unique_ptr<JobStore> store_;
  std::vector<Worker> workers_;
  std::deque<NewJob> unanswered_;
  int requests_ = 0;
  std::map<std::string, std::string> made_;  ///< job of each request id
  std::vector<std::string> acknowledged_;
  std::set<std::string> cancelled_;
  std::map<ShardKey, std::int64_t> last_token_, committed_;
  Simulated result_;
};

}  // namespace

Simulated simulate(std::uint64_t seed, int steps) { return Simulation(seed).play(steps); }

}  // namespace tet::test
