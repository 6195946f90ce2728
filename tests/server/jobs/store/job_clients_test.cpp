// What clients may rely on: jobs are made once, listed in a stable order, and gone when
// removed.
#include <set>

#include "tests/server/jobs/store/job_store_fixture.h"

namespace tet::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> ids_of(const std::vector<Job>& jobs) {
  std::vector<std::string> ids;
  for (const Job& job : jobs) ids.push_back(job.id);
  return ids;
}

TEST_P(JobStoreTest, GivesBackWhatItWasGivenAlsoAfterARestart) {
  NewJob asked = wanted("ana");
  asked.display_name = "Stanford \xc3\xa9";
  asked.spec = std::string("\0\xff spec", 7);
  asked.labels = {{"farm", "night run"}, {"shot", "a-7"}};
  asked.priority = -3;
  asked.max_attempts = 7;
  asked.ttl = absl::Hours(2);
  const std::string id = create(asked).id;
  store_ = home_->open(kRules);
  const Job job = store_->get(id).value();
  EXPECT_EQ(job.space, "ana");
  EXPECT_EQ(job.display_name, asked.display_name);
  EXPECT_EQ(job.spec, asked.spec);
  EXPECT_EQ(job.labels, asked.labels);
  EXPECT_EQ(job.priority, -3);
  EXPECT_EQ(job.max_attempts, 7);
  EXPECT_EQ(job.state, JobState::kQueued);
  EXPECT_EQ(job.version, 1);
  EXPECT_EQ(job.shard_count, 1);
  EXPECT_EQ(job.stop_time - job.create_time, absl::Hours(2));
  EXPECT_LT(absl::AbsDuration(absl::Now() - job.create_time), absl::FromChrono(kGenerousEnd));
}

TEST_P(JobStoreTest, MakesAJobOnceHoweverOftenItIsAskedFor) {
  NewJob asked = wanted();
  asked.request_id = "7";
  const CreatedJob first = store_->create(asked).value();
  const CreatedJob again = store_->create(asked).value();
  EXPECT_FALSE(first.existed);
  EXPECT_TRUE(again.existed);
  EXPECT_EQ(again.job.id, first.job.id);
  EXPECT_EQ(store_->list({}).value().jobs.size(), 1U);
}

TEST_P(JobStoreTest, RefusesARequestIdThatMadeAnotherJob) {
  NewJob asked = wanted();
  asked.request_id = "7";
  const Job job = create(asked);
  asked.spec = "other";
  const absl::Status status = store_->create(asked).status();
  EXPECT_TRUE(absl::IsAlreadyExists(status)) << status;
  EXPECT_EQ(reason_of(status), "REQUEST_ID_REUSED");
  EXPECT_THAT(std::string(status.message()), HasSubstr(job.id));
}

TEST_P(JobStoreTest, KeepsTheRequestIdsOfNamespacesApart) {
  NewJob asked = wanted("ana");
  asked.request_id = "7";
  create(asked);
  asked.space = "bob";
  EXPECT_FALSE(store_->create(asked).value().existed);
}

TEST_P(JobStoreTest, SaysWhatIsWrongWithAJob) {
  const auto message = [&](auto change) {
    NewJob asked = wanted();
    change(asked);
    const absl::Status status = store_->create(asked).status();
    EXPECT_EQ(reason_of(status), "INVALID_FIELD");
    return std::string(status.message());
  };
  EXPECT_EQ(message([](NewJob& job) { job.space = ""; }), "namespace is empty");
  EXPECT_EQ(message([](NewJob& job) { job.space = "a\n"; }),
            "namespace 'a\\n' is not printable ASCII");
  EXPECT_EQ(message([](NewJob& job) { job.priority = 101; }),
            "priority 101 is not from -100 to 100");
  EXPECT_EQ(message([](NewJob& job) { job.max_attempts = 0; }),
            "max_attempts 0 is not from 1 to 100");
  EXPECT_EQ(message([](NewJob& job) { job.ttl = absl::ZeroDuration(); }),
            "ttl 0 is not positive");
  EXPECT_EQ(message([](NewJob& job) { job.labels["A"] = ""; }),
            "labels has the key 'A', which is not [a-z][a-z0-9_./-]* of at most 63 bytes");
  EXPECT_EQ(message([](NewJob& job) { job.labels["a"] = "b\nc=d"; }),
            "labels has a='b\\nc=d', which is not printable ASCII of at most 63 bytes");
  EXPECT_EQ(message([](NewJob& job) { job.spec.resize(65537); }),
            "spec has 65537 bytes, more than 65536");
}

TEST_P(JobStoreTest, DoesNotKnowJobsThatWereNeverMade) {
  for (const absl::Status& status :
       {store_->get("x").status(), store_->cancel("x").status(), store_->retry("x").status(),
        store_->remove("x"), store_->queue_position("x").status(),
        store_->dead_letters("x").status(), store_->watch({.job = "x"}).status(),
        store_->chunk_digests("x", {}).status(), store_->count_digests("x").status()}) {
    EXPECT_TRUE(absl::IsNotFound(status)) << status;
    EXPECT_EQ(reason_of(status), "JOB_NOT_FOUND");
  }
}

TEST_P(JobStoreTest, ListsTheNewestFirst) {
  const Job first = create();
  const Job second = create();
  const Job third = create();
  EXPECT_THAT(ids_of(store_->list({}).value().jobs),
              ElementsAre(third.id, second.id, first.id));
}

TEST_P(JobStoreTest, ListsWhatPassesAllOfTheFilter) {
  NewJob asked = wanted("ana");
  asked.display_name = "shot-1";
  asked.labels = {{"farm", "night"}, {"shot", "1"}};
  const Job one = create(asked);
  asked.display_name = "shot-2";
  asked.labels["shot"] = "12";
  const Job two = create(asked);
  const Job other = create(wanted("bob"));
  store_->cancel(other.id).value();
  const auto list = [&](const JobFilter& filter) {
    return ids_of(store_->list({.filter = filter}).value().jobs);
  };
  EXPECT_THAT(list({.space = "ana"}), ElementsAre(two.id, one.id));
  EXPECT_THAT(list({.states = {JobState::kCancelled, JobState::kFailed}}),
              ElementsAre(other.id));
  EXPECT_THAT(list({.labels = {{"shot", "1"}}}), ElementsAre(one.id));
  EXPECT_THAT(list({.labels = {{"farm", "night"}, {"shot", "12"}}}), ElementsAre(two.id));
  EXPECT_THAT(list({.name_prefix = "shot-"}), ElementsAre(two.id, one.id));
  EXPECT_THAT(list({.name_prefix = "hot"}), IsEmpty());
  EXPECT_THAT(list({.created_from = two.create_time}), ElementsAre(other.id, two.id));
  EXPECT_THAT(list({.created_before = two.create_time}), ElementsAre(one.id));
}

TEST_P(JobStoreTest, PagesNeitherRepeatNorMissWhileJobsComeAndGo) {
  std::vector<std::string> there;
  for (int i = 0; i < 10; ++i) there.push_back(create().id);
  ListJobs query{.page_size = 3};
  std::vector<std::string> seen;
  do {
    const JobPage page = store_->list(query).value();
    for (const Job& job : page.jobs) seen.push_back(job.id);
    query.page_token = page.next_page_token;
    create();
    store_->cancel(seen.back()).value();
    EXPECT_EQ(store_->remove(seen.back()), absl::OkStatus());
  } while (!query.page_token.empty());
  std::ranges::reverse(there);
  EXPECT_EQ(seen, there);
}

TEST_P(JobStoreTest, EndsAPageOfJobsWhereItHasAMebibyte) {
  NewJob asked = wanted();
  asked.spec.resize(60'000, 'x');
  std::vector<std::string> there;
  for (int i = 0; i < 40; ++i) there.push_back(create(asked).id);
  ListJobs query{.page_size = 1000};
  std::vector<std::string> seen;
  std::vector<std::size_t> sizes;
  do {
    const JobPage page = store_->list(query).value();
    sizes.push_back(page.jobs.size());
    for (const Job& job : page.jobs) seen.push_back(job.id);
    query.page_token = page.next_page_token;
  } while (!query.page_token.empty());
  std::ranges::reverse(there);
  EXPECT_EQ(seen, there);
  EXPECT_THAT(sizes, ElementsAre(18U, 18U, 4U));
}

TEST_P(JobStoreTest, RefusesTokensThatAreNotOfThisList) {
  create();
  create();
  ListJobs query{.page_size = 1};
  query.page_token = store_->list(query).value().next_page_token;
  query.filter.space = "ana";
  EXPECT_EQ(reason_of(store_->list(query).status()), "INVALID_FIELD");
  query.page_token = "no token";
  EXPECT_EQ(reason_of(store_->list(query).status()), "INVALID_FIELD");
  EXPECT_EQ(reason_of(store_->list({.page_size = 1001}).status()), "INVALID_FIELD");
}

TEST_P(JobStoreTest, KnowsAJobsPlaceInTheQueue) {
  NewJob urgent = wanted();
  urgent.priority = 1;
  const Job first = create();
  const Job second = create();
  const Job overtakes = create(urgent);
  EXPECT_EQ(store_->queue_position(overtakes.id).value(), 0);
  EXPECT_EQ(store_->queue_position(first.id).value(), 1);
  EXPECT_EQ(store_->queue_position(second.id).value(), 2);
  EXPECT_EQ(store_->queue_position(second.id, 1).value(), 1);
  claim(2);
  EXPECT_EQ(store_->queue_position(first.id).value(), 0);
  EXPECT_EQ(store_->queue_position(second.id).value(), 0);
}

TEST_P(JobStoreTest, RemovesOnlyWhatIsFinished) {
  NewJob asked = wanted();
  asked.request_id = "7";
  const Job job = create(asked);
  EXPECT_EQ(reason_of(store_->remove(job.id)), "JOB_ACTIVE");
  store_->cancel(job.id).value();
  EXPECT_EQ(store_->remove(job.id), absl::OkStatus());
  EXPECT_TRUE(absl::IsNotFound(store_->get(job.id).status()));
  EXPECT_NE(store_->create(asked).value().job.id, job.id);
}

TEST_P(JobStoreTest, RefusesMoreUnfinishedJobsOfANamespaceThanItMayHave) {
  SqlJobStore::Options rules = kRules;
  rules.max_unfinished = 2;
  store_ = home_->open(rules);
  NewJob asked = wanted("ana");
  asked.request_id = "7";
  const Job first = create(asked);
  create(wanted("ana"));
  const absl::Status full = store_->create(wanted("ana")).status();
  EXPECT_EQ(reason_of(full), "QUOTA_EXCEEDED");
  EXPECT_EQ(full.message(),
            "jobs that are not finished of one namespace: 3 is over the limit of 2");
  EXPECT_TRUE(store_->create(asked).value().existed);
  EXPECT_TRUE(store_->create(wanted("bob")).ok());
  store_->cancel(first.id).value();
  EXPECT_TRUE(store_->create(wanted("ana")).ok());
}

TEST_P(JobStoreTest, RetriesNoJobBeyondThoseThatANamespaceMayHave) {
  SqlJobStore::Options rules = kRules;
  rules.max_unfinished = 2;
  store_ = home_->open(rules);
  const Job stopped = create(wanted("ana"));
  store_->cancel(stopped.id).value();
  const Job first = create(wanted("ana"));
  create(wanted("ana"));
  EXPECT_EQ(reason_of(store_->retry(stopped.id).status()), "QUOTA_EXCEEDED");
  EXPECT_EQ(get(stopped).state, JobState::kCancelled);
  store_->cancel(first.id).value();
  EXPECT_EQ(store_->retry(stopped.id).value().state, JobState::kQueued);
}

TEST_P(JobStoreTest, CountsJobsNowAndThenOnTheWayToTheLimit) {
  constexpr std::int64_t kLimit = 110;
  SqlJobStore::Options rules = kRules;
  rules.max_unfinished = kLimit;
  store_ = home_->open(rules);
  for (std::int64_t i = 0; i < kLimit; ++i) create();
  EXPECT_EQ(reason_of(store_->create(wanted()).status()), "QUOTA_EXCEEDED");
}

TEST_P(JobStoreTest, KnowsWhatJobsReadUntilTheyAreFinished) {
  using testing::UnorderedElementsAre;
  NewJob asked = wanted("ana");
  asked.input = "a";
  const Job first = create(asked);
  const Job second = create(asked);
  asked.space = "bob";
  create(asked);
  create(wanted("eve"));
  store_ = home_->open(kRules);
  const JobInput ana{"ana", "a"}, bob{"bob", "a"};
  EXPECT_THAT(store_->inputs().value(), UnorderedElementsAre(ana, bob));
  store_->cancel(first.id).value();
  EXPECT_THAT(store_->inputs().value(), UnorderedElementsAre(ana, bob));
  store_->cancel(second.id).value();
  EXPECT_THAT(store_->inputs().value(), UnorderedElementsAre(bob));
  store_->retry(first.id).value();
  EXPECT_THAT(store_->inputs().value(), UnorderedElementsAre(ana, bob));
}

TEST_P(JobStoreTest, KnowsThePlansOfJobsUntilTheyAreFinished) {
  create_planned(1, wanted("eve"));
  EXPECT_EQ(complete(claim_one()), absl::OkStatus());
  EXPECT_THAT(store_->planned().value(), IsEmpty());
  const Job job = create_planned(2);
  create();
  const std::vector<PlannedJob> planned = store_->planned().value();
  ASSERT_EQ(planned.size(), 1U);
  EXPECT_EQ(planned[0].id, job.id);
  EXPECT_EQ(planned[0].space, "ana");
  EXPECT_EQ(planned[0].header, plan_of(2).header);
  EXPECT_FALSE(planned[0].waits_for_room);
  EXPECT_EQ(planned[0].leased_shards, 0);
  store_->cancel(job.id).value();
  EXPECT_THAT(store_->planned().value(), IsEmpty());
  store_->retry(job.id).value();
  EXPECT_EQ(store_->planned().value().size(), 1U);
}

TEST_P(JobStoreTest, KnowsEachOfSeveralFilesThatAJobReads) {
  NewJob asked = wanted("ana");
  asked.input = "a b";
  create(asked);
  asked.input = "b";
  create(asked);
  const JobInput a{"ana", "a"}, b{"ana", "b"};
  EXPECT_THAT(store_->inputs().value(), testing::UnorderedElementsAre(a, b));
  // A mesh's own, a sizing's, 16 fields' and 16 of a scene.
  for (char letter = 'A'; letter < 'A' + 34; ++letter) {
    asked.input += ' ' + std::string(64, letter);
  }
  create(asked);
  EXPECT_EQ(store_->inputs().value().size(), 36U);
}

TEST_P(JobStoreTest, CountsWhatThereIs) {
  NewJob twice = wanted();
  twice.max_attempts = 2;
  create_planned(3, twice);
  create();
  const auto leases = claim(2);
  EXPECT_EQ(store_->fail(leases[0].id, absl::InternalError("no"), false), absl::OkStatus());
  const StoreCounts counts = store_->counts().value();
  EXPECT_EQ(counts.jobs.at(JobState::kRunning), 1);
  EXPECT_EQ(counts.jobs.at(JobState::kQueued), 1);
  EXPECT_EQ(counts.ready_shards, 2);
  EXPECT_EQ(counts.leased_shards, 1);
  EXPECT_EQ(counts.dead_shards, 1);
  EXPECT_GT(counts.oldest_ready_age, absl::ZeroDuration());
}

}  // namespace
}  // namespace tet::test
