// Jobs whose meshes are too large for one worker to count: several do, in shards.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/server/job_server.h"

namespace tet::test {
namespace {

namespace fs = std::filesystem;

constexpr int kRadius = 40;
const std::vector<std::string> kSmallShards{"--job-count-bricks", "64"};

class DividedCountTest : public testing::Test {
 protected:
  /// How the job stood after each plan: with shards to count, if there are any; then to mesh.
  std::vector<v1::JobProgress> plans_of(const v1::Job& job) {
    std::vector<v1::JobProgress> plans;
    for (const v1::JobEvent& event : server_.watch(job, JobServer::is_finished)) {
      if (event.change() == v1::JOB_CHANGE_PLANNED) plans.push_back(event.progress());
    }
    return plans;
  }

  /// The stored files of chunks and of blocks of surveys; not what was still being written by
  /// whoever was killed.
  std::vector<fs::path> stored_files() const {
    std::vector<fs::path> files;
    for (const auto& file : fs::recursive_directory_iterator(
             server_.folder.file("store/results/default/meshes"))) {
      const bool whole = file.path().extension() != ".part";
      if (whole && file.is_regular_file() && file.file_size() > 1000) {
        files.push_back(file.path());
      }
    }
    return files;
  }

  void expect_done(const v1::Job& job) {
    const v1::Job done = server_.wait(job);
    ASSERT_EQ(done.state(), v1::JOB_STATE_SUCCEEDED) << done.DebugString();
    EXPECT_EQ(done.determinism_alarms(), 0);
    EXPECT_TRUE(server_.result(job) == server_.stream(job)) << "other bytes";
  }

  JobServer server_{TETSTREAMD_PATH};
};

TEST_F(DividedCountTest, MakesWhatAStreamSendsByteForByte) {
  server_.start(kSmallShards);
  const v1::Job job = server_.create(server_.ball(kRadius));
  const auto plans = plans_of(job);
  ASSERT_EQ(plans.size(), 2U);
  EXPECT_GT(plans[0].shard_count(), 4);
  EXPECT_EQ(plans[0].chunk_count(), 0);
  EXPECT_GT(plans[1].chunk_count(), 0);
  expect_done(job);
}

TEST_F(DividedCountTest, CountsAtOnceWhatIsNotLarge) {
  server_.start();
  const v1::Job job = server_.create(server_.ball(kRadius));
  EXPECT_EQ(plans_of(job).size(), 1U);
}

TEST_F(DividedCountTest, LetsWorkersDoItAlthoughOneIsKilled) {
  server_.start({"--job-workers", "0"});
  const v1::Job job = server_.create(server_.ball(kRadius));
  auto first = server_.start_worker(kSmallShards);
  const auto second = server_.start_worker(kSmallShards);
  server_.watch(job, JobServer::has_a_shard);
  first.reset();
  expect_done(job);
}

TEST_F(DividedCountTest, SurveysAgainWhatWasDamaged) {
  server_.start(kSmallShards);
  const v1::Job job = server_.create(server_.ball(kRadius));
  expect_done(job);
  const std::string mesh_id = server_.get(job).header().mesh_id();
  server_.kill();
  int blocks = 0, chunks = 0;
  for (const fs::path& file : stored_files()) {
    const bool is_chunk = file.parent_path().filename() == mesh_id;
    if (is_chunk && ++chunks > 1) continue;
    blocks += is_chunk ? 0 : 1;
    std::fstream(file, std::ios::in | std::ios::out | std::ios::binary).seekp(500) << "?!";
  }
  ASSERT_GT(blocks, 4);
  server_.start(kSmallShards);
  server_.result(job);
  EXPECT_EQ(server_.status.error_code(), grpc::StatusCode::DATA_LOSS);
  server_.retry(job);
  expect_done(job);
}

}  // namespace
}  // namespace tet::test
