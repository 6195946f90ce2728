// How shards and jobs end that do not simply succeed: failures, dead letters, retries, cancels,
// times.
#include "tests/server/jobs/store/job_store_fixture.h"

namespace tet::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

TEST_P(JobStoreTest, TriesAgainWhatMayWorkLater) {
  const Job job = create_planned(1);
  EXPECT_EQ(store_->fail(claim_one().id, absl::UnavailableError("disk"), true),
            absl::OkStatus());
  EXPECT_EQ(get(job).state, JobState::kRunning);
  sleep(absl::Milliseconds(5));
  const ShardLease again = claim_one();
  EXPECT_EQ(again.attempt, 2);
  EXPECT_EQ(complete(again), absl::OkStatus());
  EXPECT_EQ(get(job).state, JobState::kSucceeded);
}

TEST_P(JobStoreTest, WaitsAfterAFailure) {
  store_ = home_->open({absl::Hours(1), absl::Hours(1)});
  create_planned(1);
  EXPECT_EQ(store_->fail(claim_one().id, absl::UnavailableError("disk"), true),
            absl::OkStatus());
  EXPECT_THAT(claim(1), IsEmpty());
  EXPECT_EQ(store_->counts().value().backing_off, 1);
}

TEST_P(JobStoreTest, WaitsLongerAfterEachFailure) {
  const absl::Duration delay = absl::Milliseconds(30);
  store_ = home_->open({delay, absl::Hours(1)});
  create_planned(1);
  ShardLease lease = claim_one();
  for (int failures = 0; failures < 2; ++failures) {
    const absl::Time failed = absl::Now();
    EXPECT_EQ(store_->fail(lease.id, absl::UnavailableError("disk"), true), absl::OkStatus());
    std::vector<ShardLease> again;
    EXPECT_TRUE(eventually([&] { return !(again = claim(1)).empty(); }));
    EXPECT_GE(absl::Now() - failed, delay * (1 << failures));
    lease = again.at(0);
  }
}

TEST_P(JobStoreTest, DeadLettersKeepTheirReasons) {
  NewJob twice = wanted();
  twice.max_attempts = 2;
  const Job job = create_planned(2, twice);
  const absl::Status error = absl::InternalError("the volume has a hole");
  const auto leases = claim(2);
  ASSERT_EQ(store_->fail(leases[0].id, error, true), absl::OkStatus());
  EXPECT_EQ(complete(leases[1]), absl::OkStatus());
  sleep(absl::Milliseconds(5));
  ASSERT_EQ(store_->fail(claim_one().id, error, true), absl::OkStatus());
  const Job failed = get(job);
  EXPECT_EQ(failed.state, JobState::kFailed);
  EXPECT_EQ(failed.done_shards, 1);
  EXPECT_EQ(failed.dead_shards, 1);
  EXPECT_EQ(failed.error.code(), error.code());
  EXPECT_EQ(failed.error.message(), error.message());
  const auto letters = store_->dead_letters(job.id).value();
  ASSERT_THAT(letters, SizeIs(1));
  EXPECT_EQ(letters[0].error.message(), error.message());
  EXPECT_EQ(reason_of(letters[0].error), "INTERNAL");
  EXPECT_EQ(letters[0].attempts, 2);
  EXPECT_EQ(letters[0].worker, "w");
}

TEST_P(JobStoreTest, DoesNotTryAgainWhatCannotWork) {
  const Job job = create();
  const absl::Status error = absl::InvalidArgumentError("spacing 0 is not positive");
  EXPECT_EQ(store_->fail(claim_one().id, error, false), absl::OkStatus());
  EXPECT_EQ(get(job).state, JobState::kFailed);
  EXPECT_EQ(get(job).error.message(), error.message());
}

TEST_P(JobStoreTest, BuriesAShardThatKillsItsWorkers) {
  const Job job = create();
  for (int attempt = 1; attempt <= 3; ++attempt) {
    EXPECT_EQ(claim_one(absl::Milliseconds(1)).attempt, attempt);
    sleep(absl::Milliseconds(5));
    EXPECT_EQ(store_->rescue().value(), 1);
  }
  EXPECT_THAT(claim(1), IsEmpty());
  const Job failed = get(job);
  EXPECT_EQ(failed.state, JobState::kFailed);
  EXPECT_EQ(reason_of(failed.error), "LEASE_EXPIRED");
  EXPECT_THAT(std::string(failed.error.message()),
              HasSubstr("worker w was not heard of in attempt 3"));
}

TEST_P(JobStoreTest, RetriesDeadLettersOnly) {
  NewJob asked = wanted();
  asked.max_attempts = 1;
  const Job job = create_planned(2, asked);
  EXPECT_EQ(reason_of(store_->retry(job.id).status()), "JOB_ACTIVE");
  const auto leases = claim(2);
  EXPECT_EQ(complete(leases[0]), absl::OkStatus());
  ASSERT_EQ(store_->fail(leases[1].id, absl::InternalError("x"), true), absl::OkStatus());
  const Job again = store_->retry(job.id).value();
  EXPECT_EQ(again.state, JobState::kQueued);
  EXPECT_EQ(again.error, absl::OkStatus());
  EXPECT_EQ(again.done_shards, 1);
  const ShardLease lease = claim_one();
  EXPECT_EQ(lease.id.shard, leases[1].id.shard);
  EXPECT_EQ(lease.attempt, 1);
  EXPECT_EQ(reason_of(complete(leases[1])), "LEASE_LOST");
  EXPECT_EQ(complete(lease), absl::OkStatus());
  EXPECT_EQ(get(job).state, JobState::kSucceeded);
  EXPECT_EQ(reason_of(store_->retry(job.id).status()), "JOB_SUCCEEDED");
}

TEST_P(JobStoreTest, TriesShardsAgainThatLostTheirBytes) {
  const Job job = create(wanted());
  ASSERT_EQ(store_->set_plan(claim_one().id, plan_of(3, 2)), absl::OkStatus());
  for (const ShardLease& lease : claim(3)) ASSERT_EQ(complete(lease), absl::OkStatus());
  ASSERT_EQ(get(job).state, JobState::kSucceeded);
  const std::int64_t lost[] = {2, 3};
  const Job again = store_->retry(job.id, lost).value();
  EXPECT_EQ(again.state, JobState::kQueued);
  EXPECT_EQ(again.done_shards, 2);
  EXPECT_EQ(again.done_chunks, 4);
  const ShardLease lease = claim_one();
  EXPECT_EQ(lease.chunks, (ChunkRange{2, 4}));
  EXPECT_TRUE(claim(1).empty());
  EXPECT_EQ(complete(lease), absl::OkStatus());
  EXPECT_EQ(get(job).state, JobState::kSucceeded);
  EXPECT_EQ(get(job).done_chunks, 6);
}

TEST_P(JobStoreTest, GivesBackAShardWithoutCountingTheAttempt) {
  create_planned(1);
  EXPECT_EQ(store_->release(claim_one().id), absl::OkStatus());
  EXPECT_EQ(claim_one().attempt, 1);
}

TEST_P(JobStoreTest, EndsAJobWholeThatIsNotToBeMade) {
  const Job job = create_planned(5);
  const auto leases = claim(3);
  EXPECT_EQ(complete(leases.at(0)), absl::OkStatus());
  const absl::Status why = absl::ResourceExhaustedError("the room is another's");
  EXPECT_EQ(store_->fail_job(leases.at(1).id, why), absl::OkStatus());
  const Job failed = get(job);
  EXPECT_EQ(failed.state, JobState::kFailed);
  EXPECT_EQ(failed.error.message(), why.message());
  EXPECT_EQ(failed.done_shards, 1);
  EXPECT_EQ(failed.dead_shards, 4);
  EXPECT_EQ(failed.leased_shards, 0);
  EXPECT_EQ(reason_of(complete(leases.at(2))), "LEASE_LOST");
  EXPECT_EQ(reason_of(store_->fail_job(leases.at(1).id, why)), "LEASE_LOST");
  EXPECT_THAT(claim(), IsEmpty());
  EXPECT_EQ(store_->retry(job.id).status(), absl::OkStatus());
  EXPECT_THAT(claim(10), SizeIs(4));
}

TEST_P(JobStoreTest, CancelWinsOverLateCompletes) {
  const Job job = create_planned(3);
  const auto leases = claim(2);
  EXPECT_EQ(complete(leases[0]), absl::OkStatus());
  const Job cancelled = store_->cancel(job.id).value();
  EXPECT_EQ(cancelled.state, JobState::kCancelled);
  EXPECT_EQ(reason_of(cancelled.error), "JOB_CANCELLED");
  const absl::Status late = complete(leases[1]);
  EXPECT_EQ(reason_of(late), "LEASE_LOST");
  EXPECT_THAT(std::string(late.message()), HasSubstr("the job is CANCELLED"));
  EXPECT_THAT(store_->heartbeat(std::vector{leases[1].id}, absl::Seconds(1)).value(),
              ElementsAre(LeaseState::kLost));
  EXPECT_THAT(claim(10), IsEmpty());
  EXPECT_EQ(get(job).done_shards, 1);
  EXPECT_EQ(get(job).dead_shards, 2);
}

TEST_P(JobStoreTest, CancellingWhatIsFinishedChangesNothing) {
  const Job job = create_planned(0);
  EXPECT_EQ(store_->cancel(job.id).value().state, JobState::kSucceeded);
}

TEST_P(JobStoreTest, TakesUpACancelledJobWhereItWas) {
  const Job job = create_planned(2);
  EXPECT_EQ(complete(claim_one()), absl::OkStatus());
  store_->cancel(job.id).value();
  store_->retry(job.id).value();
  EXPECT_EQ(complete(claim_one()), absl::OkStatus());
  EXPECT_EQ(get(job).state, JobState::kSucceeded);
}

TEST_P(JobStoreTest, ExpiresJobsThatLiveTooLong) {
  NewJob asked = wanted();
  asked.ttl = absl::Milliseconds(1);
  const Job job = create(asked);
  const Job other = create();
  sleep(absl::Milliseconds(5));
  EXPECT_EQ(store_->expire().value(), 1);
  EXPECT_EQ(store_->expire().value(), 0);
  EXPECT_EQ(get(job).state, JobState::kExpired);
  EXPECT_EQ(reason_of(get(job).error), "JOB_EXPIRED");
  EXPECT_EQ(get(other).state, JobState::kQueued);
}

TEST_P(JobStoreTest, EndsJobsThatRunTooLong) {
  NewJob asked = wanted();
  asked.timeout = absl::Milliseconds(1);
  const Job job = create(asked);
  sleep(absl::Milliseconds(5));
  EXPECT_EQ(store_->expire().value(), 0) << "time in the queue does not count";
  const ShardLease lease = claim_one();
  sleep(absl::Milliseconds(5));
  EXPECT_EQ(store_->expire().value(), 1);
  EXPECT_EQ(get(job).state, JobState::kFailed);
  EXPECT_EQ(reason_of(get(job).error), "JOB_TIMEOUT");
  EXPECT_EQ(reason_of(store_->set_plan(lease.id, plan_of(1))), "LEASE_LOST");
}

}  // namespace
}  // namespace tet::test
