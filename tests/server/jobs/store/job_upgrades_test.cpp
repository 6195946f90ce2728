// What workers of several algorithm versions, and workers in trouble, may rely on.
#include "tests/server/jobs/store/job_store_fixture.h"

namespace tet::test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

Plan plan_by(const std::string& algorithm, std::int64_t shards) {
  Plan plan = plan_of(shards);
  plan.algorithm = algorithm;
  return plan;
}

std::vector<ShardLease> claim_as(JobStore& store, const std::string& algorithm) {
  return store.claim({"w", 10, kLongLease, algorithm}).value();
}

void report(JobStore& store, const std::string& algorithm) {
  EXPECT_EQ(store.report({"of " + algorithm, algorithm, absl::OkStatus()}), absl::OkStatus());
}

TEST_P(JobStoreTest, GivesAJobOnlyToWorkersOfTheVersionThatPlannedIt) {
  create();
  EXPECT_EQ(store_->set_plan(claim_one().id, plan_by("4", 2)), absl::OkStatus());
  EXPECT_THAT(claim_as(*store_, "5"), IsEmpty());
  EXPECT_THAT(claim_as(*store_, "4"), SizeIs(2));
}

TEST_P(JobStoreTest, LetsTheWorkersOfAJobsVersionFinishIt) {
  const Job job = create();
  EXPECT_EQ(store_->set_plan(claim_one().id, plan_by("4", 1)), absl::OkStatus());
  report(*store_, "4");
  report(*store_, "5");
  EXPECT_EQ(store_->replan("5").value(), 0);
  EXPECT_EQ(complete(claim_as(*store_, "4").at(0)), absl::OkStatus());
  EXPECT_EQ(get(job).state, JobState::kSucceeded);
  EXPECT_EQ(get(job).replans, 0);
}

TEST_P(JobStoreTest, PlansAJobAgainThatNobodyElseCanGoOnWith) {
  const Job job = create();
  EXPECT_EQ(store_->set_plan(claim_one().id, plan_by("4", 3)), absl::OkStatus());
  const auto old = claim_as(*store_, "4");
  EXPECT_EQ(complete(old.at(0)), absl::OkStatus());
  EXPECT_EQ(store_->replan("5").value(), 0) << "there is nobody of version 5 either";
  report(*store_, "4");
  report(*store_, "5");
  EXPECT_EQ(store_->leave("of 4"), absl::OkStatus());
  EXPECT_EQ(store_->replan("5").value(), 1);
  const Job again = get(job);
  EXPECT_EQ(again.replans, 1);
  EXPECT_EQ(again.chunk_count, 0);
  EXPECT_EQ(again.done_chunks, 0);
  EXPECT_EQ(again.shard_count, 1);
  EXPECT_EQ(again.header, "");
  EXPECT_EQ(reason_of(complete(old.at(1))), "LEASE_LOST") << "of a worker that came back";
  const auto plan = claim_as(*store_, "5");
  ASSERT_THAT(plan, SizeIs(1));
  EXPECT_EQ(plan[0].id.shard, (ShardKey{job.id, Phase::kPlan, 0}));
  EXPECT_EQ(store_->set_plan(plan[0].id, plan_by("5", 2)), absl::OkStatus());
  for (const ShardLease& lease : claim_as(*store_, "5"))
    EXPECT_EQ(complete(lease), absl::OkStatus());
  EXPECT_EQ(get(job).state, JobState::kSucceeded);
  EXPECT_EQ(get(job).done_chunks, get(job).chunk_count);
}

TEST_P(JobStoreTest, PlansARetriedJobOfAnOlderVersionAgain) {
  const Job job = create();
  EXPECT_EQ(store_->set_plan(claim_one().id, plan_by("4", 2)), absl::OkStatus());
  const auto shards = claim_as(*store_, "4");
  EXPECT_EQ(complete(shards.at(0)), absl::OkStatus());
  EXPECT_EQ(store_->fail(shards.at(1).id, absl::InternalError("no"), false), absl::OkStatus());
  EXPECT_EQ(get(job).state, JobState::kFailed);
  EXPECT_EQ(store_->retry(job.id).status(), absl::OkStatus());
  report(*store_, "5");
  EXPECT_EQ(store_->replan("5").value(), 1);
  EXPECT_EQ(get(job).done_shards, 0);
  EXPECT_THAT(claim_as(*store_, "5"), SizeIs(1));
}

TEST_P(JobStoreTest, TellsOfAPlanThatIsMadeAnew) {
  const Job job = create();
  EXPECT_EQ(store_->set_plan(claim_one().id, plan_by("", 2)), absl::OkStatus());
  const ShardLease lease = claim_as(*store_, "5").at(0);
  EXPECT_EQ(store_->plan_anew(lease.id), absl::OkStatus());
  EXPECT_EQ(reason_of(store_->plan_anew(lease.id)), "LEASE_LOST");
  const auto page = store_->watch({.job = job.id}).value();
  EXPECT_EQ(page.events.back().change, JobChange::kReplanned);
  EXPECT_EQ(page.events.back().shard_count, 1);
}

TEST_P(JobStoreTest, CountsWorkersThatLiveAndThoseInTrouble) {
  report(*store_, "4");
  EXPECT_EQ(store_->report({"ill", "5", absl::InternalError("no disk")}), absl::OkStatus());
  const StoreCounts counts = store_->counts().value();
  EXPECT_EQ(counts.workers, 2);
  EXPECT_EQ(counts.troubled_workers, 1);
}

TEST_P(JobStoreTest, TellsWhatEachWorkerHolds) {
  const Job ours = create_planned(3);
  report(*store_, "4");
  EXPECT_EQ(store_->report({"ill", "5", absl::InternalError("no disk")}), absl::OkStatus());
  EXPECT_THAT(claim(2, "of 4"), SizeIs(2));
  create(wanted("bob"));
  EXPECT_THAT(claim(2, "of 4"), SizeIs(2));
  const WorkerPage page = store_->workers({.space = "ana"}).value();
  ASSERT_THAT(page.workers, SizeIs(2));
  EXPECT_TRUE(page.is_last);
  const KnownWorker &ill = page.workers[0], &well = page.workers[1];
  EXPECT_EQ(ill.report.name, "ill");
  EXPECT_THAT(std::string(ill.report.trouble.message()), HasSubstr("no disk"));
  EXPECT_THAT(ill.shards, IsEmpty());
  EXPECT_EQ(well.report.name, "of 4");
  EXPECT_EQ(well.report.algorithm, "4");
  EXPECT_EQ(well.report.trouble, absl::OkStatus());
  EXPECT_LE(well.seen, page.read_time);
  EXPECT_GT(well.seen, page.read_time - kWorkerAlive);
  EXPECT_EQ(well.leased_shards, 4) << "another namespace's shard counts";
  ASSERT_THAT(well.shards, SizeIs(3)) << "and has no name";
  EXPECT_EQ(well.shards[1].shard, (ShardKey{ours.id, Phase::kMesh, 1}));
  EXPECT_EQ(well.shards[1].chunks.first, plan_of(3).shards[1].first);
  EXPECT_EQ(well.shards[1].attempt, 1);
  EXPECT_GT(well.shards[1].expires, page.read_time);
}

TEST_P(JobStoreTest, TellsOfWorkersPageByPage) {
  for (const char* version : {"1", "2", "3"}) report(*store_, version);
  const WorkerPage first = store_->workers({.page_size = 2}).value();
  ASSERT_THAT(first.workers, SizeIs(2));
  EXPECT_FALSE(first.is_last);
  const std::string& last = first.workers.back().report.name;
  const WorkerPage rest = store_->workers({.page_size = 2, .after = last}).value();
  ASSERT_THAT(rest.workers, SizeIs(1));
  EXPECT_TRUE(rest.is_last);
  EXPECT_EQ(rest.workers[0].report.name, "of 3");
}

TEST_P(JobStoreTest, NamesSoManyShardsOfAWorkerAndCountsTheOthers) {
  create_planned(kMostNamedShards + 5);
  report(*store_, "4");
  EXPECT_THAT(claim(kMostNamedShards + 5, "of 4"), SizeIs(kMostNamedShards + 5));
  const WorkerPage page = store_->workers({.space = "ana"}).value();
  EXPECT_EQ(page.workers.at(0).leased_shards, kMostNamedShards + 5);
  EXPECT_THAT(page.workers.at(0).shards, SizeIs(kMostNamedShards));
}

TEST_P(JobStoreTest, TakesAShardBackWithoutAnAttemptAndSayWhy) {
  const Job job = create_planned(1);
  for (int i = 0; i < 5; ++i) {
    const ShardLease lease = claim_one();
    EXPECT_EQ(lease.attempt, 1);
    EXPECT_EQ(store_->release(lease.id, {absl::InternalError("worker w: no disk")}),
              absl::OkStatus());
  }
  const Job told = get(job);
  EXPECT_EQ(told.given_back, 5);
  EXPECT_THAT(std::string(told.trouble.message()), HasSubstr("no disk"));
  EXPECT_EQ(store_->release(claim_one().id, {absl::OkStatus(), absl::Hours(1)}),
            absl::OkStatus());
  EXPECT_THAT(claim(), IsEmpty()) << "it is left to nobody for an hour";
  EXPECT_EQ(get(job).given_back, 5);
}

TEST_P(JobStoreTest, BelongsToTheFirstStoreThatIsNamed) {
  EXPECT_EQ(store_->belongs_to("").value(), "");
  EXPECT_EQ(store_->belongs_to("a").value(), "a");
  EXPECT_EQ(store_->belongs_to("b").value(), "a");
  EXPECT_EQ(home_->open(kRules)->belongs_to("").value(), "a");
}

}  // namespace
}  // namespace tet::test
