// Pages that a client can take, whatever is on them.
#include <sqlite3.h>
#include <string>

#include <absl/strings/str_replace.h>
#include <gtest/gtest.h>

#include "tests/server/job_server.h"

namespace tet::test {
namespace {

/// A thousand workers with names as long as may be, of which each has a hundred shards of a
/// job.
constexpr char kManyLeases[] = R"sql(
WITH RECURSIVE n(i) AS (SELECT 0 UNION ALL SELECT i + 1 FROM n WHERE i < 999)
INSERT INTO workers (name, algorithm, trouble, seen_us)
  SELECT printf('%0128d', i), '', x'', strftime('%s', 'now') * 1000000 FROM n;
WITH RECURSIVE n(i) AS (SELECT 0 UNION ALL SELECT i + 1 FROM n WHERE i < 99999)
INSERT INTO queue (job_id, phase, number, first_chunk, end_chunk, rank, space, state, token, worker,
    attempt, lease_us, due_us)
  SELECT '$job', 2, i, i * 64, i * 64 + 64, 0, 'default', 1, i, printf('%0128d', i / 100), 1,
    4000000000000000, 0 FROM n;
)sql";

TEST(JobPages, OfWorkersFitAnAnswerHoweverManyShardsTheyHave) {
  JobServer server(TETSTREAMD_PATH);
  server.start({"--job-workers", "0"});
  const std::string job = server.create(server.ball(2)).name().substr(5);
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(server.folder.file("store/jobs.sqlite").c_str(), &database),
            SQLITE_OK);
  sqlite3_busy_timeout(database, 60'000);
  const std::string sql = absl::StrReplaceAll(kManyLeases, {{"$job", job}});
  EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
      << sqlite3_errmsg(database);
  sqlite3_close(database);
  int workers = 0, shards = 0;
  v1::ListWorkersRequest request;
  request.set_page_size(1000);
  do {
    grpc::ClientContext context;
    v1::ListWorkersResponse page;
    const grpc::Status status = server.jobs->ListWorkers(&context, request, &page);
    ASSERT_TRUE(status.ok()) << status.error_message();
    workers += page.workers_size();
    for (const v1::Worker& worker : page.workers()) shards += worker.shards_size();
    request.set_page_token(page.next_page_token());
  } while (!request.page_token().empty());
  EXPECT_EQ(workers, 1000);
  EXPECT_EQ(shards, 100'000);
}

}  // namespace
}  // namespace tet::test
