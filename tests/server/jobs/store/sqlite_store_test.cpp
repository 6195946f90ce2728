// Every promise of the job store, held by the embedded engine; and those that are its own.
#include <filesystem>
#include <sqlite3.h>

#include <absl/strings/str_cat.h>

#include "server/jobs/store/sqlite_connection.h"
#include "tests/server/jobs/store/job_store_fixture.h"
#include "tests/server/jobs/store/sqlite_home.h"
#include "tests/server/jobs/store/store_of_before.h"

namespace tet::test {
namespace {

INSTANTIATE_TEST_SUITE_P(Sqlite, JobStoreTest, testing::Values(&make_sqlite_home));

TEST(SqliteJobStore, ManyMayOpenANewStoreAtOnce) {
  const SqliteHome home;
  open_at_once(home);
}

TEST(SqliteJobStore, IsOpenedWhileAnotherWrites) {
  const SqliteHome home;
  home.open({});
  sqlite3* other = nullptr;
  ASSERT_EQ(sqlite3_open(home.path().c_str(), &other), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(other, "BEGIN IMMEDIATE", nullptr, nullptr, nullptr), SQLITE_OK);
  const auto store =
      open_sqlite_job_store({.path = home.path(), .busy_timeout = absl::ZeroDuration()});
  EXPECT_TRUE(store.ok()) << store.status();
  sqlite3_close(other);
}

TEST(SqliteJobStore, RefusesAFileOfALaterVersion) {
  const SqliteHome home;
  home.open({});
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(home.path().c_str(), &database), SQLITE_OK);
  sqlite3_exec(database, "PRAGMA user_version = 99", nullptr, nullptr, nullptr);
  sqlite3_close(database);
  const absl::Status status = open_sqlite_job_store({.path = home.path()}).status();
  EXPECT_TRUE(absl::IsFailedPrecondition(status)) << status;
  EXPECT_EQ(reason_of(status), "JOB_STORE_TOO_NEW");
}

TEST(SqliteJobStore, GoesOnWithWhatVersion010Left) {
  const SqliteHome home;
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(home.path().c_str(), &database), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(database, sql_of_before("sqlite").c_str(), nullptr, nullptr, nullptr),
            SQLITE_OK)
      << sqlite3_errmsg(database);
  sqlite3_close(database);
  expect_goes_on(*home.open({}));
}

TEST(SqliteJobStore, BringsTheFirstVersionUpToDate) {
  const SqliteHome home;
  NewJob asked;
  asked.space = "ana";
  const Job job = home.open({})->create(asked).value().job;
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(home.path().c_str(), &database), SQLITE_OK);
  const std::string back = std::string(kBackToTheFirst) + "PRAGMA user_version = 1";
  EXPECT_EQ(sqlite3_exec(database, back.c_str(), nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(database);
  const auto store = home.open({});
  EXPECT_EQ(store->get(job.id).value().space, "ana");
  asked.input = "a";
  EXPECT_TRUE(store->create(asked).ok());
  EXPECT_EQ(store->inputs().value().size(), 1U);
}

TEST(SqliteJobStore, RefusesAFileThatIsNoDatabase) {
  const TestFolder folder;
  const std::string path = folder.write("jobs.db", std::string(4096, 'x'));
  const absl::Status status = open_sqlite_job_store({.path = path}).status();
  EXPECT_EQ(reason_of(status), "JOB_STORE_BROKEN");
}

TEST(SqliteJobStore, KeepsFewStatementsWhateverIsAskedFor) {
  const SqliteHome home;
  const auto connection = SqliteConnection::open({.path = home.path()}).value();
  for (std::size_t i = 0; i < 2 * kMostStatements; ++i) {
    ASSERT_TRUE(connection->run("SELECT 'always'", {}).ok());
    const auto found = connection->run(absl::StrCat("SELECT $1 + ", i), {{std::int64_t{1}}});
    EXPECT_EQ(found.value().rows[0].integer(0), static_cast<std::int64_t>(i) + 1);
    EXPECT_LE(connection->count_prepared(), static_cast<int>(kMostStatements));
  }
  EXPECT_FALSE(connection->run("SELECT nothing", {}).ok());
  EXPECT_EQ(connection->count_prepared(), static_cast<int>(kMostStatements) - 1);
}

TEST(SqliteJobStore, LeavesWhatWaitsForRoomAloneForLongerEachTime) {
  const SqliteHome home;
  const auto store = home.open({});
  NewJob asked;
  asked.space = "ana";
  store->create(asked).value();
  const auto claim = [&] { return store->claim({"w", 1, absl::Seconds(30)}).value().at(0).id; };
  ASSERT_EQ(store->set_plan(claim(), plan_of(2)), absl::OkStatus());
  const auto look = SqliteConnection::open({.path = home.path()}).value();
  const auto give_back = [&](absl::Duration pause) {
    const LeaseId lease = claim();
    const absl::Time before = store->ask_time().value();
    const GiveBack how{absl::ResourceExhaustedError("no room"), pause, true};
    EXPECT_EQ(store->release(lease, how), absl::OkStatus());
    const absl::Time after = store->ask_time().value();
    const auto due = look->run("SELECT max(due_us) FROM queue WHERE state = 2", {}).value();
    return std::pair(absl::FromUnixMicros(due.rows.at(0).integer(0)) - after,
                     absl::FromUnixMicros(due.rows.at(0).integer(0)) - before);
  };
  const auto expect_pause = [](const auto& found, absl::Duration pause) {
    EXPECT_LE(found.first, pause);
    EXPECT_GE(found.second, pause);
  };
  // All that is left waits once, then both shards twice as long.
  expect_pause(give_back(absl::Seconds(10)), absl::Seconds(10));
  expect_pause(give_back(absl::Seconds(10)), absl::Seconds(10));
  ASSERT_TRUE(look->run("UPDATE queue SET due_us = 0", {}).ok());
  expect_pause(give_back(absl::Seconds(10)), absl::Seconds(20));
  expect_pause(give_back(absl::Seconds(10)), absl::Seconds(20));
  ASSERT_TRUE(look->run("UPDATE queue SET due_us = 0", {}).ok());
  expect_pause(give_back(absl::Hours(1)), kLongestRoomPause);
}

TEST(SqliteJobStore, FindsPlannedJobsByAnIndex) {
  const SqliteHome home;
  home.open({});
  const auto look = SqliteConnection::open({.path = home.path()}).value();
  const auto plan = look->run(absl::StrCat("EXPLAIN QUERY PLAN ", kPlannedJobs), {}).value();
  EXPECT_THAT(plan.rows.at(0).text(3), testing::HasSubstr("jobs_planned"));
}

TEST(SqliteJobStore, FindsPatientJobsByAnIndexInTheirOrder) {
  const SqliteHome home;
  home.open({});
  const auto look = SqliteConnection::open({.path = home.path()}).value();
  const auto plan = look->run(absl::StrCat("EXPLAIN QUERY PLAN ", kPatientJobs), {}).value();
  ASSERT_EQ(plan.rows.size(), 1U) << "and sorts nothing";
  EXPECT_THAT(plan.rows[0].text(3), testing::HasSubstr("jobs_waiting"));
}

TEST(SqliteJobStore, PurgesWhatFinishedLongAgo) {
  const SqliteHome home;
  const auto store = home.open({});
  NewJob asked;
  asked.space = "ana";
  const Job old = store->create(asked).value().job;
  store->cancel(old.id).value();
  const Job active = store->create(asked).value().job;
  const std::int64_t revision = store->revision().value();
  EXPECT_EQ(store->purge(absl::Hours(1)).value(), 0);
  EXPECT_EQ(store->purge(-absl::Hours(1)).value(), 1);
  EXPECT_TRUE(absl::IsNotFound(store->get(old.id).status()));
  EXPECT_TRUE(store->get(active.id).ok());
  EXPECT_EQ(reason_of(store->watch({}).status()), "REVISION_COMPACTED");
  EXPECT_TRUE(store->watch({.after_revision = revision}).ok());
}

}  // namespace
}  // namespace tet::test
