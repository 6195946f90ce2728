// What workers may rely on: fair claims, leases that fence, commits that happen once.
#include "tests/server/jobs/job_store_fixture.h"

namespace tet::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

TEST_P(JobStoreTest, RunsAJobFromPlanToSuccess) {
  const Job job = create();
  const ShardLease plan = claim_one();
  EXPECT_EQ(plan.id.shard, (ShardKey{job.id, Phase::kPlan, 0}));
  EXPECT_EQ(plan.attempt, 1);
  EXPECT_EQ(get(job).state, JobState::kRunning);
  ASSERT_EQ(store_->set_plan(plan.id, plan_of(2, 3)), absl::OkStatus());
  const auto shards = claim(10);
  ASSERT_THAT(shards, SizeIs(2));
  EXPECT_EQ(shards[1].chunks, (ChunkRange{3, 6}));
  EXPECT_EQ(get(job).leased_shards, 2);
  EXPECT_EQ(complete(shards[0]), absl::OkStatus());
  EXPECT_EQ(get(job).state, JobState::kRunning);
  EXPECT_EQ(get(job).done_chunks, 3);
  EXPECT_EQ(complete(shards[1]), absl::OkStatus());
  const Job done = get(job);
  EXPECT_EQ(done.state, JobState::kSucceeded);
  EXPECT_EQ(done.header, "header");
  EXPECT_EQ(done.chunk_count, 6);
  EXPECT_EQ(done.done_chunks, 6);
  EXPECT_EQ(done.done_shards, 2);
  EXPECT_LE(done.create_time, done.start_time);
  EXPECT_LE(done.start_time, done.plan_time);
  EXPECT_LE(done.plan_time, done.finish_time);
  EXPECT_THAT(claim(10), IsEmpty());
}

TEST_P(JobStoreTest, KeepsTheDigestsOfAllChunks) {
  const Job job = create();
  ASSERT_EQ(store_->set_plan(claim_one().id, plan_of(3, 4)), absl::OkStatus());
  const auto shards = claim(3);
  EXPECT_EQ(complete(shards[0]), absl::OkStatus());
  EXPECT_EQ(complete(shards[2]), absl::OkStatus());
  const auto digests = store_->chunk_digests(job.id, {2, 10}).value();
  std::vector<std::int64_t> chunks;
  for (const auto& [chunk, digest] : digests) {
    chunks.push_back(chunk);
    EXPECT_EQ(digest, digests_of({chunk, chunk + 1})[0]);
  }
  EXPECT_THAT(chunks, ElementsAre(2, 3, 8, 9));
  EXPECT_EQ(reason_of(store_->chunk_digests(job.id, {0, 13}).status()), "RANGE_BEYOND_MESH");
}

TEST_P(JobStoreTest, PlansAgainOnceAHugeMeshIsCounted) {
  const Job job = create();
  ASSERT_EQ(store_->set_plan(claim_one().id, plan_of(2, 1, Phase::kCount)), absl::OkStatus());
  for (const ShardLease& lease : claim(10)) {
    EXPECT_EQ(lease.id.shard.phase, Phase::kCount);
    EXPECT_EQ(complete(lease, 'c'), absl::OkStatus());
  }
  EXPECT_EQ(store_->count_digests(job.id).value(), digests_of({0, 2}, 'c'));
  const ShardLease plan = claim_one();
  EXPECT_EQ(plan.id.shard, (ShardKey{job.id, Phase::kPlan, 1}));
  EXPECT_EQ(reason_of(store_->set_plan(plan.id, plan_of(1, 1, Phase::kCount))), "INVALID_PLAN");
  EXPECT_EQ(store_->set_plan(plan.id, plan_of(1)), absl::OkStatus());
  EXPECT_EQ(complete(claim_one()), absl::OkStatus());
  EXPECT_EQ(get(job).state, JobState::kSucceeded);
}

TEST_P(JobStoreTest, EndsAJobWhoseMeshIsEmpty) {
  const Job job = create_planned(0);
  EXPECT_EQ(get(job).state, JobState::kSucceeded);
}

TEST_P(JobStoreTest, TakesPlansOfManyShards) {
  const Job job = create_planned(1000);
  EXPECT_EQ(get(job).shard_count, 1000);
  EXPECT_THAT(claim(1000), SizeIs(1000));
}

TEST_P(JobStoreTest, RefusesPlansWithGaps) {
  create();
  const ShardLease lease = claim_one();
  const Plan gap{
      Phase::kMesh, "", {{0, 1}, {2, 3}}
  };
  const absl::Status status = store_->set_plan(lease.id, gap);
  EXPECT_EQ(reason_of(status), "INVALID_PLAN");
  EXPECT_THAT(std::string(status.message()),
              HasSubstr("[2, 3) is empty or does not begin at 1"));
  EXPECT_EQ(store_->set_plan(lease.id, plan_of(1)), absl::OkStatus());
}

TEST_P(JobStoreTest, RefusesDigestsThatDoNotFitTheShard) {
  const Job job = create_planned(1);
  const ShardLease lease = claim_one();
  EXPECT_EQ(reason_of(store_->complete(lease.id, digests_of({0, 2}))), "INVALID_DIGESTS");
  const std::vector<ChunkDigest> short_digest = {"abc"};
  EXPECT_EQ(reason_of(store_->complete(lease.id, short_digest)), "INVALID_DIGESTS");
  EXPECT_EQ(complete(lease), absl::OkStatus());
}

TEST_P(JobStoreTest, GivesTheHighestPriorityThenTheOldest) {
  NewJob urgent = wanted();
  urgent.priority = 5;
  const Job first = create();
  const Job second = create();
  const Job overtakes = create(urgent);
  std::vector<std::string> order;
  for (int i = 0; i < 3; ++i) order.push_back(claim_one().id.shard.job);
  EXPECT_THAT(order, ElementsAre(overtakes.id, first.id, second.id));
}

TEST_P(JobStoreTest, GivesClientsEqualSharesWhoeverCameFirst) {
  for (const char* client : {"ana", "bob", "eve"}) create(wanted(client));
  const auto plans = claim(3);
  EXPECT_EQ(store_->set_plan(plans[0].id, plan_of(20)), absl::OkStatus());
  EXPECT_EQ(store_->set_plan(plans[1].id, plan_of(20)), absl::OkStatus());
  EXPECT_EQ(store_->set_plan(plans[2].id, plan_of(2)), absl::OkStatus());
  std::map<std::string, int> held;
  for (int claims = 0; claims < 3; ++claims) {
    for (const ShardLease& lease : claim(4)) {
      ++held[store_->get(lease.id.shard.job).value().client];
    }
  }
  EXPECT_EQ(held["ana"], 5);
  EXPECT_EQ(held["bob"], 5);
  EXPECT_EQ(held["eve"], 2);
}

TEST_P(JobStoreTest, RefusesClaimsWithoutSense) {
  EXPECT_EQ(reason_of(store_->claim({"", 1}).status()), "INVALID_FIELD");
  EXPECT_EQ(reason_of(store_->claim({"w", 0}).status()), "INVALID_FIELD");
  EXPECT_EQ(reason_of(store_->claim({"w", 1, absl::ZeroDuration()}).status()), "INVALID_FIELD");
}

TEST_P(JobStoreTest, FencesOffAWorkerThatWasAwayForTooLong) {
  const Job job = create_planned(1);
  const ShardLease late = claim_one(absl::Milliseconds(1));
  sleep(absl::Milliseconds(5));
  EXPECT_EQ(store_->rescue().value(), 1);
  const ShardLease next = claim_one();
  EXPECT_GT(next.id.token, late.id.token);
  EXPECT_EQ(next.attempt, 2);
  const absl::Status status = complete(late);
  EXPECT_TRUE(absl::IsAborted(status)) << status;
  EXPECT_EQ(reason_of(status), "LEASE_LOST");
  EXPECT_EQ(reason_of(store_->fail(late.id, absl::InternalError("x"), true)), "LEASE_LOST");
  EXPECT_EQ(reason_of(store_->release(late.id)), "LEASE_LOST");
  EXPECT_EQ(get(job).done_shards, 0);
  EXPECT_EQ(complete(next), absl::OkStatus());
  EXPECT_EQ(reason_of(complete(late)), "LEASE_LOST");
}

TEST_P(JobStoreTest, FencesOffALatePlan) {
  const Job job = create();
  const ShardLease late = claim_one(absl::Milliseconds(1));
  sleep(absl::Milliseconds(5));
  EXPECT_EQ(store_->rescue().value(), 1);
  const ShardLease next = claim_one();
  EXPECT_EQ(reason_of(store_->set_plan(late.id, plan_of(7))), "LEASE_LOST");
  EXPECT_EQ(store_->set_plan(next.id, plan_of(2)), absl::OkStatus());
  EXPECT_EQ(store_->set_plan(next.id, plan_of(2)), absl::OkStatus());
  EXPECT_EQ(get(job).shard_count, 2);
}

TEST_P(JobStoreTest, TakesALateCommitWhileNobodyElseHasTheShard) {
  create_planned(1);
  const ShardLease lease = claim_one(absl::Milliseconds(1));
  sleep(absl::Milliseconds(5));
  EXPECT_EQ(complete(lease), absl::OkStatus());
  EXPECT_EQ(store_->rescue().value(), 0);
}

TEST_P(JobStoreTest, HeartbeatsKeepLeasesAndTellWhichAreLost) {
  create_planned(2);
  const auto leases = claim(2, "w", absl::Milliseconds(1));
  const std::vector<LeaseId> kept = {leases[1].id};
  EXPECT_THAT(store_->heartbeat(kept, absl::Seconds(30)).value(),
              ElementsAre(Heartbeat::kHeld));
  sleep(absl::Milliseconds(5));
  EXPECT_EQ(store_->rescue().value(), 1);
  const std::vector<LeaseId> both = {leases[1].id, leases[0].id};
  EXPECT_THAT(store_->heartbeat(both, absl::Seconds(30)).value(),
              ElementsAre(Heartbeat::kHeld, Heartbeat::kLost));
}

TEST_P(JobStoreTest, TakesACommitThatIsRepeatedForWhatItIs) {
  const Job job = create_planned(2);
  const auto leases = claim(2);
  EXPECT_EQ(complete(leases[0]), absl::OkStatus());
  EXPECT_EQ(complete(leases[0]), absl::OkStatus());
  EXPECT_EQ(get(job).done_shards, 1);
  EXPECT_EQ(complete(leases[1]), absl::OkStatus());
  EXPECT_EQ(complete(leases[1]), absl::OkStatus());
  EXPECT_EQ(get(job).state, JobState::kSucceeded);
}

TEST_P(JobStoreTest, RaisesAnAlarmWhenAShardIsMadeWithOtherBytes) {
  const Job job = create_planned(1);
  const ShardLease late = claim_one(absl::Milliseconds(1));
  sleep(absl::Milliseconds(5));
  EXPECT_EQ(store_->rescue().value(), 1);
  EXPECT_EQ(complete(claim_one()), absl::OkStatus());
  const absl::Status status = complete(late, 'b');
  EXPECT_TRUE(absl::IsDataLoss(status)) << status;
  EXPECT_EQ(reason_of(status), "DETERMINISM_ALARM");
  EXPECT_EQ(get(job).alarms, 1);
  EXPECT_EQ(get(job).state, JobState::kSucceeded);
  EXPECT_EQ(store_->counts().value().alarms, 1);
  EXPECT_EQ(store_->chunk_digests(job.id, {0, 1}).value().at(0), digests_of({0, 1})[0]);
}

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

TEST_P(JobStoreTest, WaitsLongerAfterEachFailure) {
  store_ = home_->open({absl::Milliseconds(300), absl::Hours(1)});
  create_planned(1);
  EXPECT_EQ(store_->fail(claim_one().id, absl::UnavailableError("disk"), true),
            absl::OkStatus());
  EXPECT_THAT(claim(1), IsEmpty());
  EXPECT_EQ(store_->counts().value().backing_off, 1);
  sleep(absl::Milliseconds(310));
  EXPECT_THAT(claim(1), SizeIs(1));
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

TEST_P(JobStoreTest, GivesBackAShardWithoutCountingTheAttempt) {
  create_planned(1);
  EXPECT_EQ(store_->release(claim_one().id), absl::OkStatus());
  EXPECT_EQ(claim_one().attempt, 1);
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
              ElementsAre(Heartbeat::kLost));
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
