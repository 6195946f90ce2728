// What workers may rely on: fair claims, leases that fence, commits that happen once.
#include "tests/server/jobs/store/job_store_fixture.h"

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
  const Plan gap{Phase::kMesh, "", {{0, 1}, {2, 3}}};
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

TEST_P(JobStoreTest, GivesNamespacesEqualSharesWhoeverCameFirst) {
  for (const char* space : {"ana", "bob", "eve"}) create(wanted(space));
  const auto plans = claim(3);
  EXPECT_EQ(store_->set_plan(plans[0].id, plan_of(20)), absl::OkStatus());
  EXPECT_EQ(store_->set_plan(plans[1].id, plan_of(20)), absl::OkStatus());
  EXPECT_EQ(store_->set_plan(plans[2].id, plan_of(2)), absl::OkStatus());
  std::map<std::string, int> held;
  for (int claims = 0; claims < 3; ++claims) {
    for (const ShardLease& lease : claim(4)) {
      ++held[store_->get(lease.id.shard.job).value().space];
    }
  }
  EXPECT_EQ(held["ana"], 5);
  EXPECT_EQ(held["bob"], 5);
  EXPECT_EQ(held["eve"], 2);
}

TEST_P(JobStoreTest, GivesNothingOfNamespacesThatAreLeftToOthers) {
  for (const char* space : {"ana", "ana", "bob"}) create(wanted(space));
  ClaimShards beside{"w", 3};
  beside.not_of = {"ana"};
  const auto leases = store_->claim(beside).value();
  ASSERT_EQ(leases.size(), 1U);
  EXPECT_EQ(leases[0].space, "bob");
  EXPECT_THAT(store_->claim(beside).value(), testing::IsEmpty());
  EXPECT_EQ(claim(3).size(), 2U);
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

TEST_P(JobStoreTest, TellsWhichLeasesAreLostWithoutExtendingThem) {
  create();
  const Job stopped = create();
  const auto leases = claim(2, "w", absl::Milliseconds(1));
  ASSERT_THAT(leases, SizeIs(2));
  store_->cancel(stopped.id).value();
  const std::vector<LeaseId> ids = {leases[0].id, leases[1].id};
  EXPECT_THAT(store_->look_at(ids).value(), ElementsAre(LeaseState::kHeld, LeaseState::kLost));
  sleep(absl::Milliseconds(5));
  EXPECT_EQ(store_->rescue().value(), 1);
  EXPECT_THAT(store_->look_at(ids).value(), ElementsAre(LeaseState::kLost, LeaseState::kLost));
}

TEST_P(JobStoreTest, HeartbeatsKeepLeasesAndTellWhichAreLost) {
  create_planned(2);
  const auto leases = claim(2, "w", absl::Milliseconds(1));
  const std::vector<LeaseId> kept = {leases[1].id};
  EXPECT_THAT(store_->heartbeat(kept, kLongLease).value(), ElementsAre(LeaseState::kHeld));
  sleep(absl::Milliseconds(5));
  EXPECT_EQ(store_->rescue().value(), 1);
  const std::vector<LeaseId> both = {leases[1].id, leases[0].id};
  EXPECT_THAT(store_->heartbeat(both, kLongLease).value(),
              ElementsAre(LeaseState::kHeld, LeaseState::kLost));
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

}  // namespace
}  // namespace tet::test
