// What one of many jobs does to the others.
#include "client/command/job/job_session.h"

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <gtest/gtest.h>

#include "client/command/job/job_commands.h"
#include "tests/client/played_jobs.h"
#include "tests/support/test_directory.h"

namespace tet::test {
namespace {

class JobSessionTest : public testing::Test {
 protected:
  /// What becomes of three jobs of which the second fails so; `seen_` has those it came to.
  absl::Status outcome_where_one_fails(const absl::Status& failure) {
    SessionArguments arguments;
    arguments.server.address = "127.0.0.1:1";
    const auto session = JobSession::open(arguments);
    EXPECT_TRUE(session.ok()) << session.status();
    const auto act = [&](const std::string& name) {
      seen_.push_back(name);
      return name == "two" ? failure : absl::OkStatus();
    };
    return for_each_of(**session, {"one", "two", "three"}, act, never_);
  }

  std::vector<std::string> seen_;
  Cancellation never_;
};

TEST_F(JobSessionTest, GoesOnBehindAJobWhoseResultIsDamaged) {
  EXPECT_TRUE(absl::IsDataLoss(outcome_where_one_fails(absl::DataLossError("a chunk"))));
  EXPECT_EQ(seen_.size(), 3U);
}

TEST_F(JobSessionTest, EndsWhereTheServerIsGone) {
  EXPECT_TRUE(absl::IsUnavailable(outcome_where_one_fails(absl::UnavailableError("gone"))));
  EXPECT_EQ(seen_.size(), 2U);
}

/// How fetching a job into a folder ends where the server answers with one of this name.
absl::Status fetch_from_a_server_that_says(const std::string& name,
                                           const std::filesystem::path& folder) {
  PlayedJobs jobs;
  jobs.get = [&](int, const std::string&, v1::Job& job) {
    job.set_name(name);
    job.set_state(v1::JOB_STATE_SUCCEEDED);
    return absl::OkStatus();
  };
  const std::string address = jobs.listen();
  CLI::App app;
  const Command fetch = add_fetch_command(app);
  const std::string into = folder / "meshes";
  std::vector<std::string> words{"--into", into, "--server", address,
                                 "jobs/019310c2a5d84f6b8e7a2c11"};
  std::reverse(words.begin(), words.end());  // as CLI11 takes them
  app.parse(words);
  const Cancellation never;
  return fetch(never);
}

TEST(JobFetch, WritesNoFileThatTheServerNames) {
  const TestDirectory folder;
  const absl::Status status = fetch_from_a_server_that_says("jobs/../stolen", folder.file(""));
  EXPECT_TRUE(absl::IsDataLoss(status)) << status;
  EXPECT_NE(status.message().find("jobs/../stolen"), std::string::npos) << status;
}

}  // namespace
}  // namespace tet::test
