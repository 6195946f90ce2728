// Every promise of the job store, held by the engine for many machines; and those that are its
// own.
#include <libpq-fe.h>
#include <thread>

#include <absl/strings/str_cat.h>

#include "server/jobs/store/postgres_connection.h"
#include "tests/server/jobs/store/job_store_fixture.h"
#include "tests/server/jobs/store/postgres_home.h"
#include "tests/server/jobs/store/store_of_before.h"

namespace tet::test {
namespace {

INSTANTIATE_TEST_SUITE_P(Postgres, JobStoreTest, testing::Values(&make_emptied_postgres_home));

NewJob wanted() {
  NewJob job;
  job.space = "ana";
  return job;
}

/// The first column of the first row.
std::string query(const std::string& connection, const std::string& sql) {
  PGconn* connected = PQconnectdb(connection.c_str());
  PGresult* result = PQexec(connected, sql.c_str());
  const std::string found = PQntuples(result) > 0 ? PQgetvalue(result, 0, 0) : "";
  PQclear(result);
  PQfinish(connected);
  return found;
}

TEST(PostgresJobStore, SaysWhyThereIsNoConnection) {
  const absl::Status status =
      open_postgres_job_store({.connection = "host=/nowhere user=x"}).status();
  EXPECT_TRUE(absl::IsUnavailable(status)) << status;
  EXPECT_EQ(reason_of(status), "JOB_STORE_UNAVAILABLE");
  EXPECT_THAT(std::string(status.message()), testing::HasSubstr("/nowhere"));
}

/// All rows of all tables, and where sequences are.
std::string contents(const PostgresHome& home) {
  return query(
             home.connection(),
             "SELECT string_agg(relname || table_to_xml(oid, true, true, '')::text, ' ' ORDER "
             "BY relname) FROM pg_class WHERE relnamespace = current_schema::regnamespace AND "
             "relkind IN ('r', 'p') AND NOT relispartition") +
         query(home.connection(),
               "SELECT string_agg(sequencename || COALESCE(last_value, 0), ' ' ORDER BY "
               "sequencename) FROM pg_sequences WHERE schemaname = current_schema");
}

// What the claims of the job store begin with.
TEST(PostgresJobStore, IsAsNewWhenItsTablesAreEmptied) {
  const PostgresHome made, used;
  made.open({});
  const auto store = used.open({});
  const Job job = store->create(wanted()).value().job;
  EXPECT_EQ(store->belongs_to("a").value(), "a");
  EXPECT_EQ(store->report({"w", "4", absl::OkStatus()}), absl::OkStatus());
  EXPECT_NE(contents(used), contents(made));
  used.empty();
  EXPECT_EQ(contents(used), contents(made));
  EXPECT_NE(contents(used), "");
  EXPECT_TRUE(absl::IsNotFound(store->get(job.id).status()));
}

TEST(PostgresJobStore, ManyMayOpenANewStoreAtOnce) {
  const PostgresHome home;
  open_at_once(home);
}

TEST(PostgresJobStore, RefusesTheSchemaOfALaterVersion) {
  const PostgresHome home;
  home.open({});
  query(home.connection(), "UPDATE schema_version SET version = 99");
  const absl::Status status =
      open_postgres_job_store({.connection = home.connection()}).status();
  EXPECT_EQ(reason_of(status), "JOB_STORE_TOO_NEW") << status;
}

TEST(PostgresJobStore, GoesOnWithWhatVersion010Left) {
  const PostgresHome home;
  postgres_server().run(home.schema(), sql_of_before("postgres"));
  expect_goes_on(*home.open({}));
}

TEST(PostgresJobStore, BringsTheFirstVersionUpToDate) {
  const PostgresHome home;
  const Job job = home.open({})->create(wanted()).value().job;
  query(home.connection(),
        std::string(kBackToTheFirst) + "UPDATE schema_version SET version = 1");
  const auto store = home.open({});
  EXPECT_EQ(store->get(job.id).value().space, "ana");
  NewJob asked = wanted();
  asked.input = "a";
  EXPECT_TRUE(store->create(asked).ok());
  EXPECT_EQ(store->inputs().value().size(), 1U);
}

TEST(PostgresJobStore, ForgetsOldJobsByDroppingTheirPartitions) {
  // There are partitions for this span and two more: all of them may be over before there is a
  // job, on a busy machine.
  std::unique_ptr<PostgresHome> home;
  std::unique_ptr<JobStore> store;
  Job old;
  ASSERT_TRUE(eventually([&] {
    store.reset();
    home = std::make_unique<PostgresHome>();
    store = home->open_with({.connection = home->connection(), .partition = absl::Seconds(3)});
    old = store->create(wanted()).value().job;
    store->cancel(old.id).value();
    return query(home->connection(), "SELECT count(*) FROM jobs_default") == "0";
  }));
  sleep(absl::Milliseconds(3100));
  const Job active = store->create(wanted()).value().job;
  const std::int64_t revision = store->revision().value();
  EXPECT_EQ(store->purge(absl::ZeroDuration()).value(), 1);
  EXPECT_TRUE(absl::IsNotFound(store->get(old.id).status()));
  EXPECT_TRUE(store->get(active.id).ok());
  EXPECT_EQ(reason_of(store->watch({}).status()), "REVISION_COMPACTED");
  EXPECT_TRUE(store->watch({.after_revision = revision}).ok());
}

/// Whether somebody waits for a lock on a table of this store.
bool anybody_waits(const PostgresHome& home) {
  return query(home.connection(),
               "SELECT count(*) FROM pg_locks JOIN pg_class ON pg_class.oid = relation WHERE "
               "relnamespace = current_schema::regnamespace AND NOT granted") != "0";
}

TEST(PostgresJobStore, DropsPartitionsWithoutWaitingInACircleWithReaders) {
  const PostgresHome home;
  const auto store =
      home.open_with({.connection = home.connection(), .partition = absl::Hours(1)});
  const Job job = store->create(wanted()).value().job;
  store->cancel(job.id).value();
  // A reader that has locked the table, and not yet the partition.
  const auto reader = PostgresConnection::open(home.connection(), absl::Hours(1)).value();
  ASSERT_TRUE(reader->begin().ok());
  ASSERT_TRUE(reader->run_script("LOCK TABLE ONLY jobs IN ACCESS SHARE MODE").ok());
  // It gives up after a while, and may do so before the reader gets a processor.
  const auto purge = [&] {
    const absl::Status purged = store->purge(-absl::Hours(3)).status();
    EXPECT_FALSE(absl::IsAborted(purged)) << purged;
    return purged.ok();
  };
  std::thread purges([&] { EXPECT_TRUE(eventually(purge)); });
  EXPECT_TRUE(eventually([&] { return anybody_waits(home); }));
  const auto read = reader->run_script("SELECT count(*)::text FROM jobs");
  EXPECT_TRUE(read.ok()) << read.status();
  reader->roll_back();
  purges.join();
  EXPECT_TRUE(absl::IsNotFound(store->get(job.id).status()));
}

/// Drops all partitions, as another server that purges at the same time.
void drop_partitions_as_another(PostgresConnection& other) {
  constexpr char kDrop[] = R"sql(
DO $$ DECLARE name text; BEGIN
  FOR name IN SELECT inhrelid::regclass FROM pg_inherits
      JOIN pg_class ON pg_class.oid = inhrelid
      WHERE inhparent IN ('jobs'::regclass, 'shards'::regclass, 'events'::regclass)
        AND relname NOT LIKE '%default' LOOP
    EXECUTE 'DROP TABLE ' || name;
  END LOOP;
END $$)sql";
  const auto dropped = other.run_script(kDrop);
  EXPECT_TRUE(dropped.ok()) << dropped.status();
  EXPECT_TRUE(other.commit().ok());
}

/// A purge that waits for another server's locks, which then drops all that there is to drop.
void expect_purge_beside(const std::string& lock) {
  const PostgresHome home;
  const auto store =
      home.open_with({.connection = home.connection(), .partition = absl::Hours(1)});
  const Job job = store->create(wanted()).value().job;
  store->cancel(job.id).value();
  store->revision().value();  // all events have theirs
  const auto other = PostgresConnection::open(home.connection(), absl::Hours(1)).value();
  ASSERT_TRUE(other->begin().ok());
  ASSERT_TRUE(other->run_script(lock).ok());
  const auto purge = [&] {
    const absl::Status purged = store->purge(-absl::Hours(3)).status();
    EXPECT_FALSE(absl::IsInternal(purged)) << purged;
    return purged.ok();
  };
  std::thread purges([&] { EXPECT_TRUE(eventually(purge)); });
  EXPECT_TRUE(eventually([&] { return anybody_waits(home); }));
  drop_partitions_as_another(*other);
  purges.join();
}

TEST(PostgresJobStore, PurgesBesideAnotherServerThatIsFaster) {
  // It waits before it looks at a partition, or only before it drops it.
  expect_purge_beside("LOCK TABLE ONLY jobs IN ACCESS EXCLUSIVE MODE");
  expect_purge_beside("LOCK TABLE ONLY jobs IN ACCESS SHARE MODE");
}

/// What the planner would do with a large table.
TEST(PostgresJobStore, FindsPlannedJobsByAnIndex) {
  const PostgresHome home;
  home.open({});
  const auto connection = PostgresConnection::open(home.connection()).value();
  ASSERT_TRUE(connection->run_script("SET enable_seqscan = off").ok());
  const auto plan = connection->run(absl::StrCat("EXPLAIN ", kPlannedJobs), {}).value();
  std::string told;
  for (const SqlRow& row : plan.rows) told += row.text(0) + "\n";
  EXPECT_THAT(told, testing::HasSubstr("phase_id_idx"));
}

TEST(PostgresJobStore, KeepsJobsOfSpansThatHaveNoPartition) {
  const PostgresHome home;
  const auto store =
      home.open_with({.connection = home.connection(), .partition = absl::Milliseconds(1)});
  sleep(absl::Milliseconds(20));
  const Job job = store->create(wanted()).value().job;
  EXPECT_EQ(query(home.connection(), "SELECT count(*) FROM jobs_default"), "1");
  store->cancel(job.id).value();
  EXPECT_EQ(store->purge(-absl::Hours(1)).value(), 1);
  EXPECT_TRUE(absl::IsNotFound(store->get(job.id).status()));
}

TEST(PostgresJobStore, IsNotHeldUpByAProcessThatStoppedInTheMiddleOfATransaction) {
  const PostgresHome home;
  const auto store = home.open({});
  const Job job = store->create(wanted()).value().job;
  std::unique_ptr<PostgresConnection> stopped;
  // It is ended before, too, where this thread is what stops in between.
  ASSERT_TRUE(eventually([&] {
    stopped = PostgresConnection::open(home.connection()).value();
    return stopped->begin().ok() &&
           stopped->run("SELECT id FROM jobs WHERE id = $1 FOR UPDATE", {{job.id}}).ok();
  }));
  EXPECT_EQ(store->cancel(job.id).value().state, JobState::kCancelled);
  EXPECT_TRUE(absl::IsUnavailable(stopped->commit()));
}

TEST(PostgresJobStore, HasNoQueryCompiled) {
  const PostgresHome home;
  const auto connection = PostgresConnection::open(home.connection()).value();
  const auto told = connection->run("SELECT current_setting('jit')", {});
  ASSERT_TRUE(told.ok()) << told.status();
  EXPECT_EQ(told->rows.at(0).text(0), "off");
}

TEST(PostgresJobStore, KeepsFewStatementsWhateverIsAskedFor) {
  const PostgresHome home;
  const auto connection = PostgresConnection::open(home.connection()).value();
  for (std::size_t i = 0; i < 2 * kMostStatements; ++i) {
    const auto found = connection->run(absl::StrCat("SELECT $1 + ", i), {{std::int64_t{1}}});
    EXPECT_EQ(found.value().rows[0].integer(0), static_cast<std::int64_t>(i) + 1);
  }
  const auto prepared = connection->run("SELECT count(*) FROM pg_prepared_statements", {});
  EXPECT_EQ(prepared.value().rows[0].integer(0), static_cast<std::int64_t>(kMostStatements));
}

TEST(PostgresJobStore, FindsChangesWithoutNotifications) {
  const PostgresHome home;
  const auto store =
      home.open_with({.connection = home.connection(), .poll = absl::Milliseconds(50)});
  store->create(wanted()).value();
  const std::int64_t revision = store->revision().value();
  std::thread silent([&] {
    sleep(absl::Milliseconds(100));
    query(home.connection(),
          "INSERT INTO events SELECT nextval('event_ids'), 0, job_id, space, 2, 9, 1, 0, 0, 0, "
          "0, 0, 0 FROM events");
  });
  const auto page =
      store->watch({.after_revision = revision, .wait = absl::FromChrono(kGenerousEnd)});
  EXPECT_EQ(page.value().events.size(), 1U);
  silent.join();
}

}  // namespace
}  // namespace tet::test
