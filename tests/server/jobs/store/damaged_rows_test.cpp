// Numbers of the jobs' database that nobody of ours has written: no call about them ends the
// server, and none stays without an answer.
#include <csignal>
#include <memory>
#include <sqlite3.h>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/server/job_server.h"
#include "tests/server/reason_of.h"
#include "tests/server/until_healthy.h"
#include "tests/support/eventually.h"

namespace tet::test {
namespace {

using grpc::StatusCode;

/// The database that a running server has, too.
class Database {
 public:
  explicit Database(const std::string& path) {
    sqlite3_open(path.c_str(), &database_);
    sqlite3_busy_timeout(database_, 60'000);
  }
  ~Database() { sqlite3_close(database_); }
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  /// The first column of all rows.
  std::vector<std::string> run(const std::string& sql) {
    std::vector<std::string> values;
    char* error = nullptr;
    const auto add = [](void* to, int, char** columns, char**) {
      static_cast<std::vector<std::string>*>(to)->emplace_back(columns[0] ? columns[0] : "");
      return 0;
    };
    sqlite3_exec(database_, sql.c_str(), add, &values, &error);
    EXPECT_EQ(error, nullptr) << sql << ": " << error;
    sqlite3_free(error);
    return values;
  }

  std::vector<std::string> numbers_of(const std::string& table) {
    return run("SELECT name FROM pragma_table_info('" + table +
               "') WHERE type = 'INTEGER' AND name NOT IN ('id', 'number')");
  }

 private:
  sqlite3* database_ = nullptr;
};

class DamagedRows : public testing::Test {
 protected:
  DamagedRows() {
    start();
    ball_ = server_.ball(2);
  }

  void start() { server_.start({"--job-workers", "0"}); }

  template <class Request, class Response>
  void ask(grpc::Status (v1::JobService::Stub::*method)(grpc::ClientContext*,
                                                        const Request&,
                                                        Response*),
           Request request,
           const std::string& what) {
    Response response;
    const grpc::Status status = asked_until_healthy([&] {
      grpc::ClientContext context;
      context.set_deadline(std::chrono::system_clock::now() + kGenerousEnd);
      return (server_.jobs.get()->*method)(&context, request, &response);
    });
    EXPECT_THAT(
        status.error_code(),
        testing::Not(testing::AnyOf(StatusCode::UNAVAILABLE, StatusCode::UNKNOWN,
                                    StatusCode::UNIMPLEMENTED, StatusCode::DEADLINE_EXCEEDED)))
        << what << ": " << status.error_message();
  }

  void ask_everything(const v1::Job& job, const std::string& what) {
    using Stub = v1::JobService::Stub;
    const auto about = [&](auto request) {
      request.set_name(job.name());
      return request;
    };
    ask(&Stub::ListJobs, v1::ListJobsRequest(), what);
    ask(&Stub::GetJob, about(v1::GetJobRequest()), what);
    ask(&Stub::ListDeadShards, about(v1::ListDeadShardsRequest()), what);
    ask(&Stub::ListWorkers, v1::ListWorkersRequest(), what);
    ask(&Stub::CancelJob, about(v1::CancelJobRequest()), what);
    ask(&Stub::RetryJob, about(v1::RetryJobRequest()), what);
    ask(&Stub::CancelJob, about(v1::CancelJobRequest()), what);
    ask(&Stub::ListJobs, v1::ListJobsRequest(), what);
    ask(&Stub::DeleteJob, about(v1::DeleteJobRequest()), what);
    server_.watch(job, [](const v1::JobEvent&) { return true; });
  }

  JobServer server_{TETSTREAMD_PATH};
  v1::Job ball_;
};

TEST_F(DamagedRows, EndNoServerAndKeepNoCallWaiting) {
  Database database(server_.folder.file("store/jobs.sqlite"));
  for (const std::string table : {"jobs", "queue", "shards", "events"}) {
    const auto columns = database.numbers_of(table);
    ASSERT_FALSE(columns.empty()) << table;
    for (const std::string& column : columns) {
      for (const char* number : {"-9223372036854775808", "-1", "99", "315576000000000000",
                                 "9223372036854775806", "9223372036854775807"}) {
        const std::string what = table + "." + column + " = " + number;
        const v1::Job job = server_.create(ball_);
        ASSERT_TRUE(server_.status.ok()) << what << ": " << server_.status.error_message();
        if (table == "shards") server_.cancel(job);
        const std::string key = table == "jobs" ? "id" : "job_id";
        database.run("UPDATE " + table + " SET " + column + " = " + number + " WHERE " + key +
                     " = '" + job.name().substr(5) + "'");
        ask_everything(job, what);
        // What is left of it is not the next one's affair.
        for (const std::string other : {"queue", "shards", "requests", "events"}) {
          database.run("DELETE FROM " + other + " WHERE job_id = '" + job.name().substr(5) +
                       "'");
        }
        database.run("DELETE FROM jobs WHERE id = '" + job.name().substr(5) + "'");
        ASSERT_FALSE(HasFailure());
      }
    }
  }
  EXPECT_EQ(::kill(server_.process->pid(), 0), 0);
}

TEST_F(DamagedRows, OfAnEarlierVersionEndNoServerThatStarts) {
  const v1::Job job = server_.create(ball_);
  Database database(server_.folder.file("store/jobs.sqlite"));
  // As a job with a ttl of ten thousand years was stored.
  database.run(
      "UPDATE jobs SET ttl_us = 315576000000000000, expire_us = 317000000000000000, "
      "stop_us = 317000000000000000");
  EXPECT_EQ(server_.get(job).name(), job.name());
  start();
  EXPECT_EQ(server_.get(job).stop_time().seconds(), 253'402'300'799);
  ask(&v1::JobService::Stub::ListJobs, v1::ListJobsRequest(), "ListJobs");
  server_.start({"--job-workers", "1"});
  EXPECT_EQ(server_.wait(job).state(), v1::JOB_STATE_SUCCEEDED);
}

}  // namespace
}  // namespace tet::test
