// Where the queue of jobs saturates: a farm of workers that make nothing. Each claims shards as
// a worker does, waits for as long as a shard would take, and commits; the job store is real,
// and every commit reaches the disk.
//   farm_bench [--engine sqlite|postgres] [--workers 1 --workers 1000] [--shard-seconds 1]
// A line for each number of workers, in the form of docs/jobs.md.
#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <absl/time/clock.h>
#include <absl/time/time.h>

#include "server/jobs/store/postgres_job_store.h"
#include "server/jobs/store/sqlite_job_store.h"
#include "tests/server/jobs/store/made_up_work.h"
#include "tests/server/jobs/store/postgres_server.h"
#include "tests/server/test_folder.h"

namespace tet::bench {
namespace {

constexpr std::int64_t kShardsOfAJob = 1000, kSpaces = 10, kChunksOfAShard = 64;
constexpr absl::Duration kLease = absl::Seconds(30);

struct Options {
  std::string engine = "postgres";
  std::vector<int> workers = {1, 10, 100, 300, 1000};
  double shard_seconds = 1, seconds = 15;
  int processes = 25;
};

using Stores = std::vector<std::unique_ptr<JobStore>>;

/// Opens one store as many times as that many processes would; workers share these evenly.
class Place {
 public:
  explicit Place(const Options& options) : options_(options) {
    if (options.engine == "postgres") {
      server_ = std::make_unique<test::PostgresServer>(true, 9 * options.processes + 20);
    }
  }

  Stores open() {
    const std::string name = absl::StrCat("farm", ++count_);
    if (server_) server_->make_schema(name);
    Stores stores;
    for (int i = 0; i < options_.processes; ++i) stores.push_back(open(name));
    return stores;
  }

 private:
  std::unique_ptr<JobStore> open(const std::string& name) const {
    return server_ ? open_postgres_job_store({.connection = server_->connection(name)}).value()
                   : open_sqlite_job_store({.path = folder_.file(name)}).value();
  }

  const Options& options_;
  const test::TestFolder folder_;
  std::unique_ptr<test::PostgresServer> server_;
  int count_ = 0;
};

/// Jobs of at least `count` shards altogether, all of them ready.
void queue_shards(JobStore& store, std::int64_t count) {
  const std::int64_t jobs = count / kShardsOfAJob + 1;
  for (std::int64_t job = 0; job < jobs; ++job) {
    NewJob wanted;
    wanted.space = absl::StrCat("space-", job % kSpaces);
    wanted.spec = std::string(300, 's');
    store.create(wanted).value();
  }
  const auto plans = store.claim({"planner", jobs}).value();
  for (const ShardLease& plan : plans) {
    const auto shards = test::plan_of(kShardsOfAJob, kChunksOfAShard);
    if (!store.set_plan(plan.id, shards).ok()) std::abort();
  }
}

/// What a worker saw.
struct Seen {
  std::int64_t done = 0, failed = 0;
  std::vector<double> claim_ms, commit_ms;
};

template <class Call>
auto timed(std::vector<double>& times_ms, const Call& call) {
  const absl::Time start = absl::Now();
  auto result = call();
  times_ms.push_back(absl::ToDoubleMilliseconds(absl::Now() - start));
  return result;
}

/// One thread of a worker: a shard is done while the next is claimed already.
class Worker {
 public:
  Worker(JobStore& store, int number, const Options& options)
      : store_(store),
        name_(absl::StrCat("worker-", number)),
        shard_seconds_(options.shard_seconds),
        random_(static_cast<std::uint64_t>(number)) {}

  Seen run(const std::atomic<bool>& stopping) {
    while (!stopping) {
      const std::uint64_t seen = store_.signal();
      if (held_.size() < 2 && !claim() && held_.empty()) {
        store_.wait(seen, absl::Seconds(1));
        continue;
      }
      do_one();
    }
    return std::move(seen_);
  }

 private:
  bool claim() {
    const auto room = 2 - std::ssize(held_);
    auto leases = timed(seen_.claim_ms, [&] { return store_.claim({name_, room, kLease}); });
    if (!leases.ok()) {
      ++seen_.failed;
      return false;
    }
    held_.insert(held_.end(), leases->begin(), leases->end());
    return !leases->empty();
  }

  void do_one() {
    const double seconds = shard_seconds_ * std::uniform_real_distribution(0.5, 1.5)(random_);
    absl::SleepFor(absl::Seconds(seconds));
    beat();
    const ShardLease lease = held_.front();
    held_.erase(held_.begin());
    const auto digests = test::digests_of(lease.chunks);
    const absl::Status status =
        timed(seen_.commit_ms, [&] { return store_.complete(lease.id, digests); });
    ++(status.ok() ? seen_.done : seen_.failed);
  }

  void beat() {
    if (absl::Now() - last_beat_ < kLease / 3) return;
    last_beat_ = absl::Now();
    std::vector<LeaseId> leases;
    for (const ShardLease& lease : held_) leases.push_back(lease.id);
    if (!store_.heartbeat(leases, kLease).ok()) ++seen_.failed;
  }

  JobStore& store_;
  const std::string name_;
  const double shard_seconds_;
  std::mt19937_64 random_;
  std::vector<ShardLease> held_;
  absl::Time last_beat_ = absl::Now();
  Seen seen_;
};

/// All workers, for so long.
Seen work(const Stores& stores, int count, const Options& options) {
  std::vector<Seen> seen(static_cast<std::size_t>(count));
  std::atomic<bool> stopping = false;
  std::vector<std::jthread> threads;
  threads.reserve(seen.size());
  for (int i = 0; i < count; ++i) {
    threads.emplace_back([&, i] {
      JobStore& store = *stores[static_cast<std::size_t>(i) % stores.size()];
      seen[static_cast<std::size_t>(i)] = Worker(store, i, options).run(stopping);
    });
  }
  absl::SleepFor(absl::Seconds(options.seconds));
  stopping = true;
  threads.clear();
  Seen all;
  for (const Seen& one : seen) {
    all.done += one.done;
    all.failed += one.failed;
    all.claim_ms.insert(all.claim_ms.end(), one.claim_ms.begin(), one.claim_ms.end());
    all.commit_ms.insert(all.commit_ms.end(), one.commit_ms.begin(), one.commit_ms.end());
  }
  return all;
}

std::string quantiles(std::vector<double>& times_ms) {
  std::ranges::sort(times_ms);
  const auto at = [&](double part) {
    return times_ms.empty() ? 0
                            : times_ms[static_cast<std::size_t>(
                                  part * static_cast<double>(times_ms.size() - 1))];
  };
  return absl::StrFormat("%.1f / %.1f", at(0.5), at(0.99));
}

}  // namespace

void measure(Place& place, int workers, const Options& options) {
  const double asked = workers / options.shard_seconds;
  const Stores stores = place.open();
  queue_shards(*stores[0], static_cast<std::int64_t>(asked * options.seconds * 1.5) + 10);
  const absl::Time start = absl::Now();
  Seen seen = work(stores, workers, options);
  const double seconds = absl::ToDoubleSeconds(absl::Now() - start);
  std::cout << absl::StrFormat("| %s | %d | %.0f | %.0f | %s | %s | %d |\n", options.engine,
                               workers, asked, static_cast<double>(seen.done) / seconds,
                               quantiles(seen.claim_ms), quantiles(seen.commit_ms), seen.failed)
            << std::flush;
}

}  // namespace tet::bench

int main(int argc, char** argv) {
  CLI::App app("workers that make nothing, at a job store");
  tet::bench::Options options;
  app.add_option("--engine", options.engine, "sqlite or postgres")
      ->check(CLI::IsMember({"sqlite", "postgres"}));
  app.add_option("--workers", options.workers, "how many; several are measured in turn");
  app.add_option("--shard-seconds", options.shard_seconds, "what a shard takes")
      ->check(CLI::PositiveNumber);
  app.add_option("--seconds", options.seconds, "how long each is measured")
      ->check(CLI::PositiveNumber);
  app.add_option("--processes", options.processes, "that workers share, of 8 connections each")
      ->check(CLI::Range(1, 1000));
  CLI11_PARSE(app, argc, argv);
  tet::bench::Place place(options);
  std::cout
      << "| engine | workers | asked, shards/s | done, shards/s | claim, ms: median / 99% "
         "| commit, ms: median / 99% | failed |\n| --- | --- | --- | --- | --- | --- | --- "
         "|\n";
  for (const int workers : options.workers) tet::bench::measure(place, workers, options);
  return 0;
}
