// What is known of jobs that wait for room among the results.
#include "tests/server/jobs/store/job_store_fixture.h"

namespace tet::test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

GiveBack for_room() {
  return {with_reason(absl::ResourceExhaustedError("no room"), "RESULTS_FULL"),
          absl::ZeroDuration(), true};
}

TEST_P(JobStoreTest, KnowsWhichPlannedJobsWaitForRoomNow) {
  const Job job = create();
  EXPECT_EQ(store_->release(claim_one().id, for_room()), absl::OkStatus());
  const auto now = [&] { return store_->planned().value().at(0); };
  EXPECT_EQ(store_->set_plan(claim_one().id, plan_of(3)), absl::OkStatus());
  EXPECT_FALSE(now().waits_for_room) << "it waited before it was planned";
  EXPECT_EQ(store_->release(claim_one().id, for_room()), absl::OkStatus());
  EXPECT_TRUE(now().waits_for_room);
  const ShardLease lease = claim_one();
  EXPECT_TRUE(now().waits_for_room) << "nothing is done yet";
  EXPECT_EQ(now().leased_shards, 1);
  EXPECT_EQ(complete(lease), absl::OkStatus());
  EXPECT_FALSE(now().waits_for_room);
  EXPECT_EQ(store_->release(claim_one().id, {for_room().why}), absl::OkStatus());
  EXPECT_FALSE(now().waits_for_room) << "it was given back for another reason";
  EXPECT_EQ(store_->release(claim_one().id, for_room()), absl::OkStatus());
  store_->cancel(job.id).value();
  store_->retry(job.id).value();
  EXPECT_FALSE(now().waits_for_room) << "it begins anew";
  EXPECT_EQ(reason_of(get(job).trouble), "RESULTS_FULL") << "which stays for people";
}

TEST_P(JobStoreTest, NoLongerWaitsForRoomOnceAShardHasFoundSome) {
  const Job job = create_planned(2);
  const ShardLease early = claim_one();
  EXPECT_EQ(store_->release(early.id, for_room()), absl::OkStatus());
  const ShardLease lease = claim_one();
  const auto waits = [&] {
    EXPECT_EQ(store_->planned().value().at(0).waits_for_room, get(job).waits_for_room);
    return get(job).waits_for_room;
  };
  EXPECT_EQ(reason_of(store_->found_room(early.id)), "LEASE_LOST");
  EXPECT_TRUE(waits());
  const std::int64_t version = get(job).version;
  EXPECT_EQ(store_->found_room(lease.id), absl::OkStatus());
  EXPECT_FALSE(waits()) << "though nothing is done yet";
  EXPECT_EQ(get(job).version, version);
  EXPECT_EQ(store_->found_room(lease.id), absl::OkStatus());
  EXPECT_EQ(store_->release(lease.id, for_room()), absl::OkStatus());
  EXPECT_TRUE(waits()) << "it found less than it needs";
}

TEST_P(JobStoreTest, KnowsWhichJobsHaveLongWaitedForRoomToBeBegun) {
  const auto look_in_vain = [&](std::int64_t looks) {
    for (std::int64_t i = 0; i < looks; ++i) {
      EXPECT_EQ(store_->release(claim_one().id, for_room()), absl::OkStatus());
    }
  };
  const auto patient = [&] {
    const std::vector<PatientJob> jobs = store_->patient().value();
    std::vector<std::string> ids;
    for (const PatientJob& job : jobs) ids.push_back(job.id);
    return ids;
  };
  const Job older = create();
  look_in_vain(kPatientLooks - 1);
  EXPECT_THAT(patient(), IsEmpty());
  look_in_vain(1);
  EXPECT_THAT(patient(), ElementsAre(older.id));
  NewJob asked = wanted("bob");
  asked.priority = 1;
  asked.spec = "a mesh";
  const Job urgent = create(asked);
  look_in_vain(kPatientLooks);
  EXPECT_THAT(patient(), ElementsAre(urgent.id, older.id));
  const PatientJob first = store_->patient().value().at(0);
  EXPECT_EQ(first.space, "bob");
  EXPECT_EQ(first.spec, "a mesh");
  EXPECT_EQ(first.priority, 1);
  EXPECT_EQ(store_->set_plan(claim_one().id, plan_of(1)), absl::OkStatus());
  EXPECT_THAT(patient(), ElementsAre(older.id)) << "the other one is begun";
  look_in_vain(kPatientLooks);
  EXPECT_THAT(patient(), ElementsAre(older.id));
  store_->cancel(older.id).value();
  EXPECT_THAT(patient(), IsEmpty());
}

}  // namespace
}  // namespace tet::test
