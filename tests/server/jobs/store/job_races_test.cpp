// Many workers at once, in threads and in processes, some of them killed: each shard is
// committed once, and each job that was acknowledged is finished.
#include <fstream>
#include <functional>
#include <mutex>
#include <random>
#include <set>
#include <sstream>
#include <unistd.h>

#include "tests/server/jobs/store/job_store_fixture.h"
#include "tests/server/jobs/store/looked_at.h"
#include "tests/server/jobs/store/postgres_home.h"
#include "tests/server/jobs/store/sqlite_home.h"
#include "tests/server/program.h"

namespace tet::test {
namespace {

class JobStoreRaces : public JobStoreTest {
 protected:
  /// Runs `body` in so many threads, each with a store of its own.
  void in_threads(int count, const std::function<void(JobStore&, int)>& body) {
    std::vector<std::thread> threads;
    for (int i = 0; i < count; ++i) {
      threads.emplace_back([&, i] {
        const auto own = home_->open(kRules);
        body(*own, i);
      });
    }
    for (std::thread& thread : threads) thread.join();
  }

  bool is_in_postgres() const { return home_->worker_arguments().at(0) == "postgres"; }
  /// How much the database looks at for this, by a store that is opened for it, while there is
  /// no other.
  std::int64_t looked_at(const std::function<void(JobStore&)>& body) {
    const auto so_far = [&] {
      return is_in_postgres() ? postgres_rows_read(home_->worker_arguments().at(1))
                              : SqliteSteps::count();
    };
    const std::int64_t before = so_far();
    body(*home_->open(kRules));
    return so_far() - before;
  }

  std::vector<std::string> create_many(int count) {
    NewJob job = wanted();
    job.max_attempts = 100;  // killed workers use them up
    std::vector<std::string> ids;
    for (int i = 0; i < count; ++i) ids.push_back(create(job).id);
    return ids;
  }

  void expect_all_done(const std::vector<std::string>& ids, std::int64_t shards) {
    for (const std::string& id : ids) {
      const Job job = store_->get(id).value();
      EXPECT_EQ(job.state, JobState::kSucceeded) << job.error;
      EXPECT_EQ(job.done_shards, shards);
      EXPECT_EQ(job.alarms, 0);
      const auto digests = store_->chunk_digests(id, {0, shards}).value();
      EXPECT_EQ(std::ssize(digests), shards);
    }
  }
};

INSTANTIATE_TEST_SUITE_P(Sqlite, JobStoreRaces, testing::Values(&make_sqlite_home));
INSTANTIATE_TEST_SUITE_P(Postgres, JobStoreRaces, testing::Values(&make_postgres_home));

TEST_P(JobStoreRaces, TheSameRequestFromManyThreadsMakesOneJob) {
  NewJob asked = wanted();
  asked.request_id = "7";
  std::mutex mutex;
  std::set<std::string> ids;
  int made = 0;
  in_threads(8, [&](JobStore& store, int) {
    const CreatedJob created = store.create(asked).value();
    const std::lock_guard lock(mutex);
    ids.insert(created.job.id);
    made += created.existed ? 0 : 1;
  });
  EXPECT_EQ(ids.size(), 1U);
  EXPECT_EQ(made, 1);
}

TEST_P(JobStoreRaces, EachShardIsCommittedByOneOfManyClaimers) {
  constexpr int kJobs = 8;
  constexpr int kShards = 10;
  const auto ids = create_many(kJobs);
  std::mutex mutex;
  std::map<ShardKey, int> commits;
  in_threads(6, [&](JobStore& store, int i) {
    for (int idle = 0; idle < 20;) {
      const auto leases = store.claim({absl::StrCat("w", i), 3}).value();
      if (leases.empty()) sleep(absl::Milliseconds(5));
      idle = leases.empty() ? idle + 1 : 0;
      for (const ShardLease& lease : leases) {
        const absl::Status status = lease.id.shard.phase == Phase::kPlan
                                        ? store.set_plan(lease.id, plan_of(kShards))
                                        : store.complete(lease.id, digests_of(lease.chunks));
        EXPECT_EQ(status, absl::OkStatus());
        const std::lock_guard lock(mutex);
        ++commits[lease.id.shard];
      }
    }
  });
  expect_all_done(ids, kShards);
  EXPECT_EQ(commits.size(), kJobs * (kShards + 1));
  for (const auto& [shard, count] : commits) EXPECT_EQ(count, 1);
}

TEST_P(JobStoreRaces, ACancelledJobStaysAsItWasWhenTheCancelWasAnswered) {
  for (int round = 0; round < 5; ++round) {
    const Job job = create_planned(8);
    const auto leases = claim(8);
    Job cancelled;
    in_threads(3, [&](JobStore& store, int i) {
      if (i == 0) {
        cancelled = store.cancel(job.id).value();
      } else {
        for (std::size_t l = static_cast<std::size_t>(i) - 1; l < leases.size(); l += 2) {
          const absl::Status status =
              store.complete(leases[l].id, digests_of(leases[l].chunks));
          EXPECT_TRUE(status.ok() || absl::IsAborted(status)) << status;
        }
      }
    });
    const Job after = get(job);
    EXPECT_EQ(after.version, cancelled.version);
    EXPECT_EQ(after.done_shards, cancelled.done_shards);
    EXPECT_EQ(after.done_shards + after.dead_shards, 8);
  }
}

/// Worker processes that are started again whenever they are killed.
class Crew {
 public:
  Crew(std::vector<std::string> place, int count) : place_(std::move(place)) {
    for (int i = 0; i < count; ++i) hire();
  }

  void kill_one(std::mt19937& random) {
    workers_[random() % workers_.size()].program->send(SIGKILL);
    hire();
  }
  void wait() {
    for (Worker& worker : workers_) {
      const int code = worker.program->wait();
      EXPECT_TRUE(code == 0 || code == -1) << worker.program->err();
    }
  }
  /// How often each shard's commit was acknowledged.
  std::map<std::string, int> commits() const {
    std::map<std::string, int> commits;
    for (const Worker& worker : workers_) {
      std::istringstream lines(worker.program->out());
      std::string job, phase, number, token;
      while (lines >> job >> phase >> number >> token) {
        ++commits[absl::StrCat(job, " ", phase, " ", number)];
      }
    }
    return commits;
  }

 private:
  struct Worker {
    std::unique_ptr<TestFolder> folder;
    std::unique_ptr<Program> program;
  };

  void hire() {
    std::vector<std::string> arguments = {CLAIM_WORKER_PATH};
    arguments.insert(arguments.end(), place_.begin(), place_.end());
    arguments.push_back(absl::StrCat("worker-", workers_.size()));
    arguments.emplace_back("5");
    auto folder = std::make_unique<TestFolder>();
    auto program = std::make_unique<Program>(*folder, arguments);
    workers_.push_back({std::move(folder), std::move(program)});
  }

  const std::vector<std::string> place_;
  std::vector<Worker> workers_;
};

TEST_P(JobStoreRaces, KilledWorkersLoseNothingAndCommitNothingTwice) {
  const auto ids = create_many(40);
  std::mt19937 random(7);
  Crew crew(home_->worker_arguments(), 3);
  for (int kills = 0; kills < 12; ++kills) {
    sleep(absl::Milliseconds(20 + random() % 80));
    crew.kill_one(random);
  }
  crew.wait();
  expect_all_done(ids, 5);
  for (const auto& [shard, count] : crew.commits()) EXPECT_EQ(count, 1) << shard;
}

TEST(PostgresKilled, LosesNothingThatWasAcknowledged) {
  PostgresServer server;
  server.make_schema("farm");
  const std::string place = server.connection("farm");
  const auto store = open_postgres_job_store({.connection = place}).value();
  Crew crew({"postgres", place}, 2);
  std::thread killer([&] {
    for (int kills = 0; kills < 4; ++kills) {
      sleep(absl::Milliseconds(300));
      server.kill();
      server.start();
    }
  });
  std::set<std::string> ids;
  for (int i = 0; i < 60; ++i) {
    NewJob job;
    job.space = "ana";
    job.max_attempts = 100;
    job.request_id = absl::StrCat(i);
    auto created = store->create(job);
    while (absl::IsUnavailable(created.status())) {
      sleep(absl::Milliseconds(10));
      created = store->create(job);
    }
    ids.insert(created.value().job.id);
    sleep(absl::Milliseconds(20));
  }
  killer.join();
  EXPECT_EQ(ids.size(), 60U);
  crew.wait();
  server.kill();
  server.start();
  EXPECT_TRUE(store->counts().ok())
      << "connections that broke while they were idle are replaced";
  for (const std::string& id : ids) {
    const Job job = store->get(id).value();
    EXPECT_EQ(job.state, JobState::kSucceeded) << job.error;
    EXPECT_EQ(job.done_shards, 5);
  }
  for (const auto& [shard, count] : crew.commits()) EXPECT_EQ(count, 1) << shard;
}

std::int64_t resident_bytes() {
  std::int64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages >> pages;
  return pages * ::sysconf(_SC_PAGESIZE);
}

/// What the calls of a store look at that grow with its queue if they are not made with care.
struct LookedAt {
  std::int64_t claim = 0, list = 0, counts = 0;
};

TEST_P(JobStoreRaces, TenThousandQueuedJobsAreNoBurden) {
  constexpr int kFew = 1000, kMany = 10'000;
  const std::int64_t before = resident_bytes();
  const SqliteSteps steps;
  store_.reset();  // so that nobody else's work is counted
  const auto create_jobs = [&](int count) {
    in_threads(4, [&](JobStore& store, int i) {
      NewJob job = wanted(absl::StrCat("space-", i));
      job.labels = {{"farm", "night"}};
      for (int j = 0; j < count / 4; ++j) EXPECT_TRUE(store.create(job).ok());
    });
  };
  const auto look = [&] {
    return LookedAt{
        looked_at([&](JobStore& store) {
          EXPECT_EQ(store.claim({"w", 16, absl::Hours(1)}).value().size(), 16U);
        }),
        looked_at([](JobStore& store) { EXPECT_EQ(store.list({}).value().jobs.size(), 100U); }),
        looked_at([](JobStore& store) { store.counts().value(); })};
  };
  create_jobs(kFew);
  const LookedAt few = look();
  create_jobs(kMany - kFew);
  const LookedAt many = look();
  EXPECT_GE(few.claim, 16);
  EXPECT_GE(few.list, 100);
  EXPECT_GE(few.counts, kFew);
  if (is_in_postgres()) {
    // Its plans change with what it has found out about its tables; a claim may read each ready
    // shard's entries of an index, a few times.
    EXPECT_LE(many.claim, 10 * kMany);
    EXPECT_LE(many.list, kFew);
    EXPECT_LE(many.counts, 10 * kMany);
  } else {
    EXPECT_LE(many.claim, 2 * few.claim);
    EXPECT_LE(many.list, 2 * few.list);
    EXPECT_LE(many.counts, 15 * few.counts) << "each job a few times, and none against others";
  }
  const auto store = home_->open(kRules);
  EXPECT_EQ(store->counts().value().jobs.at(JobState::kQueued), kMany - 2 * 16);
  EXPECT_LT(resident_bytes() - before, 48 << 20) << "caches of a few connections, not jobs";
}

}  // namespace
}  // namespace tet::test
