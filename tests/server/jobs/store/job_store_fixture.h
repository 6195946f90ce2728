// What every test of a job store begins with, for either engine.
#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <absl/status/status.h>
#include <absl/time/clock.h>
#include <absl/time/time.h>
#include <gmock/gmock.h>

#include "proto/convert/status.h"
#include "server/jobs/store/job_store.h"
#include "tests/server/jobs/store/made_up_work.h"
#include "tests/server/jobs/store/store_home.h"
#include "tests/support/eventually.h"

namespace tet::test {

/// One that does not end while a test's threads stand still.
constexpr absl::Duration kLongLease = absl::Hours(1);

inline void sleep(absl::Duration time) { absl::SleepFor(time); }

/// Eight threads, as eight processes would, open a store that nobody opened before.
inline void open_at_once(const StoreHome& home) {
  std::vector<std::thread> processes;
  for (int i = 0; i < 8; ++i) {
    processes.emplace_back([&] { EXPECT_NE(home.open({}), nullptr); });
  }
  for (std::thread& process : processes) process.join();
}

class JobStoreTest : public testing::TestWithParam<MakeHome> {
 protected:
  JobStoreTest() : home_(GetParam()()), store_(home_->open(kRules)) {}

  static NewJob wanted(const std::string& space = "ana") {
    NewJob job;
    job.space = space;
    return job;
  }

  Job create(const NewJob& job) { return store_->create(job).value().job; }
  Job create() { return create(wanted()); }
  Job get(const Job& job) { return store_->get(job.id).value(); }

  std::vector<ShardLease> claim(std::int64_t most = 1,
                                const std::string& worker = "w",
                                absl::Duration lease = kLongLease) {
    return store_->claim({worker, most, lease}).value();
  }
  /// The test fails unless there is one.
  ShardLease claim_one(absl::Duration lease = kLongLease) {
    const auto leases = claim(1, "w", lease);
    EXPECT_EQ(leases.size(), 1U);
    return leases.empty() ? ShardLease{} : leases[0];
  }
  /// A job of so many shards that are ready.
  Job create_planned(std::int64_t shards, const NewJob& job = wanted()) {
    const Job created = create(job);
    EXPECT_EQ(store_->set_plan(claim_one().id, plan_of(shards)), absl::OkStatus());
    return created;
  }
  absl::Status complete(const ShardLease& lease, char salt = 'a') {
    return store_->complete(lease.id, digests_of(lease.chunks, salt));
  }

  // Failed shards are soon ready again, so that tests need not wait.
  const SqlJobStore::Options kRules{absl::Milliseconds(1), absl::Milliseconds(4)};
  const std::unique_ptr<StoreHome> home_;
  std::unique_ptr<JobStore> store_;
};

}  // namespace tet::test
