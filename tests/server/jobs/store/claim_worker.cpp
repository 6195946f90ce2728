// A worker that makes nothing: it claims, plans, commits, and can be killed at any moment.
//   claim_worker sqlite PATH | postgres CONNECTION  NAME SHARDS
// A plan gets SHARDS shards. Each commit that was acknowledged is a line on standard output:
// job, phase, number, token. It ends when for a second there was no job that was not finished.
#include <cstdlib>
#include <iostream>
#include <memory>
#include <string>

#include <absl/strings/str_cat.h>

#include "server/jobs/store/postgres_job_store.h"
#include "server/jobs/store/sqlite_job_store.h"
#include "tests/server/jobs/store/made_up_work.h"

namespace tet::test {
namespace {

// Short, so that a killed worker's shards are soon somebody else's, and longer than a commit
// takes on a busy disk.
constexpr absl::Duration kLease = absl::Seconds(1);
constexpr absl::Duration kPause = absl::Milliseconds(20);
constexpr int kPatience = 50;  // pauses

std::unique_ptr<JobStore> open(const std::string& engine, const std::string& place) {
  while (true) {
    auto store = engine == "sqlite" ? open_sqlite_job_store({.path = place})
                                    : open_postgres_job_store({.connection = place});
    if (store.ok()) return *std::move(store);
    if (!absl::IsUnavailable(store.status())) std::exit(2);
    absl::SleepFor(kPause);
  }
}

/// Commits until it is known what became of it.
absl::Status commit(JobStore& store, const ShardLease& lease, std::int64_t shards) {
  while (true) {
    const absl::Status status = lease.id.shard.phase == Phase::kPlan
                                    ? store.set_plan(lease.id, plan_of(shards))
                                    : store.complete(lease.id, digests_of(lease.chunks));
    if (!absl::IsUnavailable(status)) return status;
    absl::SleepFor(kPause);
  }
}

bool all_finished(JobStore& store) {
  const auto counts = store.counts();
  return counts.ok() && !counts->jobs.contains(JobState::kQueued) &&
         !counts->jobs.contains(JobState::kRunning);
}

int work(JobStore& store, const std::string& name, std::int64_t shards) {
  for (int idle = 0; idle < kPatience;) {
    const auto leases = store.claim({name, 4, kLease});
    if (!leases.ok() || leases->empty()) {
      idle = all_finished(store) ? idle + 1 : 0;
      (void)store.rescue();
      absl::SleepFor(kPause);
      continue;
    }
    for (const ShardLease& lease : *leases) {
      const absl::Status status = commit(store, lease, shards);
      const ShardKey& key = lease.id.shard;
      if (status.ok()) {
        std::cout << absl::StrCat(key.job, " ", static_cast<int>(key.phase), " ", key.number,
                                  " ", lease.id.token, "\n")
                  << std::flush;
      } else if (!absl::IsAborted(status)) {
        std::cerr << status << "\n";
        return 3;
      }
    }
  }
  return 0;
}

}  // namespace
}  // namespace tet::test

int main(int argc, char** argv) {
  if (argc != 5) return 1;
  const auto store = tet::test::open(argv[1], argv[2]);
  return tet::test::work(*store, argv[3], std::atoll(argv[4]));
}
