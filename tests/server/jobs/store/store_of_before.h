// Job stores as version 0.1.0 left them.
#pragma once

#include <fstream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "server/jobs/store/job_store.h"
#include "tests/server/jobs/store/made_up_work.h"

namespace tet::test {

/// The statements that make it, of this engine.
inline std::string sql_of_before(const std::string& engine) {
  std::ifstream file(std::string(JOBS_OF_BEFORE) + "/" + engine + ".sql");
  std::stringstream text;
  text << file.rdbuf();
  EXPECT_FALSE(text.str().empty());
  return text.str();
}

/// One of its jobs is done, one queued, and one cancelled: all is there, and goes on.
inline void expect_goes_on(JobStore& store) {
  const auto jobs = store.list({}).value().jobs;
  ASSERT_EQ(jobs.size(), 3U);
  const Job cancelled = jobs[0], queued = jobs[1], done = jobs[2];
  EXPECT_EQ(done.state, JobState::kSucceeded);
  EXPECT_EQ(done.done_chunks, 18);
  EXPECT_EQ(done.labels, (Labels{{"night", "monday"}}));
  EXPECT_EQ(store.chunk_digests(done.id, {0, 18}).value().size(), 18U);
  EXPECT_EQ(queued.state, JobState::kQueued);
  EXPECT_EQ(queued.priority, 5);
  EXPECT_EQ(queued.replans, 0);
  EXPECT_EQ(queued.trouble, absl::OkStatus());
  EXPECT_EQ(cancelled.state, JobState::kCancelled);
  EXPECT_FALSE(store.watch({.job = done.id}).value().events.empty());
  EXPECT_TRUE(store.retry(cancelled.id).ok());
  for (int i = 0; i < 2; ++i) {
    const auto leases = store.claim({"w", 1, absl::Seconds(30), "5"}).value();
    ASSERT_EQ(leases.size(), 1U);
    Plan plan = plan_of(1);
    plan.algorithm = "5";
    EXPECT_EQ(store.set_plan(leases[0].id, plan), absl::OkStatus());
    const auto shards = store.claim({"w", 1, absl::Seconds(30), "5"}).value();
    ASSERT_EQ(shards.size(), 1U);
    EXPECT_EQ(store.complete(shards[0].id, digests_of(shards[0].chunks)), absl::OkStatus());
  }
  EXPECT_EQ(store.get(queued.id).value().state, JobState::kSucceeded);
  EXPECT_EQ(store.get(cancelled.id).value().state, JobState::kSucceeded);
}

}  // namespace tet::test
