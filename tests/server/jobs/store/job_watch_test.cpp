// What watchers may rely on: every change once, in order, however often they come back.
#include <atomic>

#include "tests/server/jobs/store/job_store_fixture.h"

namespace tet::test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// Whoever waits this long was not woken.
const absl::Duration kNotWoken = absl::FromChrono(kGenerousEnd);

std::vector<JobChange> changes_of(const EventPage& page) {
  std::vector<JobChange> changes;
  for (const JobEvent& event : page.events) changes.push_back(event.change);
  return changes;
}

TEST_P(JobStoreTest, TellsEachChangeOfAJob) {
  const Job job = create_planned(2);
  const auto leases = claim(2);
  EXPECT_EQ(complete(leases[0]), absl::OkStatus());
  ASSERT_EQ(store_->fail(leases[1].id, absl::InternalError("x"), false), absl::OkStatus());
  store_->retry(job.id).value();
  store_->cancel(job.id).value();
  EXPECT_EQ(store_->remove(job.id), absl::OkStatus());
  const EventPage page = store_->watch({.job = job.id}).value();
  EXPECT_THAT(changes_of(page),
              ElementsAre(JobChange::kCreated, JobChange::kStarted, JobChange::kPlanned,
                          JobChange::kShardDone, JobChange::kShardDead, JobChange::kFinished,
                          JobChange::kRetried, JobChange::kFinished, JobChange::kDeleted));
  for (std::size_t i = 0; i < page.events.size(); ++i) {
    EXPECT_EQ(page.events[i].version, static_cast<std::int64_t>(i) + 1);
  }
  EXPECT_EQ(page.events[3].done_chunks, 1);
  EXPECT_EQ(page.events[5].state, JobState::kFailed);
}

TEST_P(JobStoreTest, GoesOnAfterTheRevisionThatWasSeenLast) {
  for (int i = 0; i < 5; ++i) create();
  const EventPage first = store_->watch({.limit = 3}).value();
  EXPECT_EQ(first.events.size(), 3U);
  store_ = home_->open(kRules);
  const EventPage rest = store_->watch({.after_revision = first.revision}).value();
  EXPECT_EQ(rest.events.size(), 2U);
  EXPECT_EQ(rest.revision, store_->revision().value());
  EXPECT_THAT(store_->watch({.after_revision = rest.revision}).value().events, IsEmpty());
}

TEST_P(JobStoreTest, TellsANamespaceOfItsOwnJobsOnly) {
  create(wanted("ana"));
  const Job job = create(wanted("bob"));
  const EventPage page = store_->watch({.space = "bob"}).value();
  ASSERT_EQ(page.events.size(), 1U);
  EXPECT_EQ(page.events[0].job, job.id);
  EXPECT_EQ(page.events[0].space, "bob");
  EXPECT_EQ(page.revision, store_->revision().value());
}

TEST_P(JobStoreTest, DoesNotKnowRevisionsOfTheFuture) {
  create();
  EXPECT_EQ(reason_of(store_->watch({.after_revision = 1000}).status()), "REVISION_UNKNOWN");
}

TEST_P(JobStoreTest, AWatcherIsWokenByAChangeFromAnotherProcess) {
  const auto elsewhere = home_->open(kRules);
  const std::int64_t revision = store_->revision().value();
  std::thread other([&] {
    sleep(absl::Milliseconds(50));
    EXPECT_TRUE(elsewhere->create(wanted()).ok());
  });
  const absl::Time start = absl::Now();
  const EventPage page = store_->watch({.after_revision = revision, .wait = kNotWoken}).value();
  EXPECT_THAT(changes_of(page), ElementsAre(JobChange::kCreated));
  EXPECT_LT(absl::Now() - start, kNotWoken);
  other.join();
}

TEST_P(JobStoreTest, AWatchWithoutChangesEndsInTime) {
  const absl::Time start = absl::Now();
  EXPECT_THAT(store_->watch({.wait = absl::Milliseconds(50)}).value().events, IsEmpty());
  EXPECT_GE(absl::Now() - start, absl::Milliseconds(49));
}

TEST_P(JobStoreTest, AnIdleWorkerIsWokenByAJob) {
  const std::uint64_t seen = store_->signal();
  std::thread other([&] {
    sleep(absl::Milliseconds(20));
    create();
  });
  const absl::Time start = absl::Now();
  store_->wait(seen, kNotWoken);
  EXPECT_LT(absl::Now() - start, kNotWoken);
  other.join();
}

TEST_P(JobStoreTest, AnIdleWorkerIsWokenToEnd) {
  const std::uint64_t seen = store_->signal();
  store_->wake_all();
  const absl::Time start = absl::Now();
  store_->wait(seen, kNotWoken);
  EXPECT_LT(absl::Now() - start, kNotWoken);
}

TEST_P(JobStoreTest, LookingForWorkInVainWakesNobody) {
  const std::uint64_t seen = store_->signal();
  for (int i = 0; i < 10; ++i) {
    EXPECT_THAT(claim(), IsEmpty());
    EXPECT_EQ(store_->rescue().value(), 0);
    EXPECT_EQ(store_->expire().value(), 0);
  }
  // A listener that has just reached its server tells that once.
  EXPECT_LE(store_->signal(), seen + 1);
}

TEST_P(JobStoreTest, WatchersMissNothingAndSeeNothingTwiceWhileManyWrite) {
  constexpr int kWriters = 4;
  constexpr int kJobs = 10;
  std::vector<std::thread> writers;
  for (int i = 0; i < kWriters; ++i) {
    writers.emplace_back([&] {
      const auto own = home_->open(kRules);
      for (int j = 0; j < kJobs; ++j) {
        const Job job = own->create(wanted()).value().job;
        EXPECT_TRUE(own->cancel(job.id).ok());
      }
    });
  }
  std::map<std::string, std::int64_t> version_of;
  std::int64_t revision = 0;
  for (std::size_t seen = 0; seen < 2 * kWriters * kJobs;) {
    const auto reconnected = home_->open(kRules);
    const EventPage page =
        reconnected->watch({.after_revision = revision, .limit = 7, .wait = kNotWoken}).value();
    ASSERT_FALSE(page.events.empty()) << seen << " events were seen";
    for (const JobEvent& event : page.events) {
      EXPECT_GT(event.revision, revision);
      revision = event.revision;
      EXPECT_EQ(event.version, ++version_of[event.job]);
    }
    seen += page.events.size();
  }
  for (std::thread& writer : writers) writer.join();
  EXPECT_EQ(version_of.size(), kWriters * kJobs);
  EXPECT_THAT(store_->watch({.after_revision = revision}).value().events, IsEmpty());
}

}  // namespace
}  // namespace tet::test
