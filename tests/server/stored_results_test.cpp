// What finished jobs leave behind: meshes that jobs and streams are served from, damaged ones
// and those that are being read.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/server/job_server.h"
#include "tests/server/reason_of.h"
#include "tests/support/eventually.h"

namespace tet::test {
namespace {

namespace fs = std::filesystem;

class StoredResults : public testing::Test {
 protected:
  /// Files of stored chunks. Not what a worker that lost its lease is still writing, nor what
  /// is gone before it is looked at: the server goes on meanwhile.
  std::vector<fs::path> stored_chunks() const {
    std::vector<fs::path> chunks;
    for (const auto& file : fs::recursive_directory_iterator(meshes_)) {
      std::error_code gone;
      const bool whole = file.path().extension() != ".part" && file.is_regular_file(gone);
      if (whole && file.file_size(gone) > 10'000 && !gone) chunks.push_back(file.path());
    }
    return chunks;
  }

  fs::path folder_of(const v1::Job& job) {
    const std::string mesh = server_.get(job).header().mesh_id();
    return meshes_ / mesh.substr(0, 2) / mesh;
  }

  /// Jobs that are planned and not finished: they were, and lost a chunk each. The server has
  /// no workers from then on.
  std::vector<v1::Job> unfinished(const std::vector<int>& radii) {
    server_.start();
    std::vector<v1::Job> jobs;
    for (const int radius : radii) jobs.push_back(server_.create(server_.ball(radius)));
    for (const v1::Job& job : jobs) {
      EXPECT_EQ(server_.wait(job).state(), v1::JOB_STATE_SUCCEEDED);
    }
    server_.start({"--job-workers", "0"});
    for (const v1::Job& job : jobs) {
      std::vector<fs::path> chunks = stored_chunks();
      std::erase_if(chunks, [folder = folder_of(job)](const fs::path& chunk) {
        return chunk.parent_path() != folder;
      });
      fs::remove(*std::ranges::max_element(
          chunks, {}, [](const fs::path& chunk) { return fs::file_size(chunk); }));
      EXPECT_EQ(server_.retry(job).state(), v1::JOB_STATE_QUEUED);
    }
    return jobs;
  }

  std::uint64_t stored_bytes() const {
    std::uint64_t bytes = 0;
    for (const fs::path& chunk : stored_chunks()) bytes += fs::file_size(chunk);
    return bytes;
  }

  /// One worker, and room for so many bytes of results.
  void start_with_room(std::uint64_t bytes) {
    server_.start({"--job-workers", "1", "--job-lease-seconds", "10", "--result-bytes",
                   std::to_string(bytes)});
  }

  JobServer server_{TETSTREAMD_PATH};
  const fs::path meshes_ = server_.folder.file("store/results/default/meshes");
  const grpc::Status& status_ = server_.status;
};

TEST_F(StoredResults, NoticesADamagedChunkAndMakesItAgain) {
  server_.start();
  const v1::Job job = server_.create(server_.ball(16));
  ASSERT_EQ(server_.wait(job).state(), v1::JOB_STATE_SUCCEEDED);
  const auto before = server_.result(job);
  const fs::path chunk = stored_chunks().at(0);
  std::fstream(chunk, std::ios::in | std::ios::out | std::ios::binary).seekp(5000) << "?!";
  server_.result(job);
  EXPECT_EQ(status_.error_code(), grpc::StatusCode::DATA_LOSS);
  EXPECT_EQ(reason_of(status_), "tetstream/CHUNK_DAMAGED");
  EXPECT_NE(server_.retry(job).state(), v1::JOB_STATE_SUCCEEDED);
  ASSERT_EQ(server_.wait(job).state(), v1::JOB_STATE_SUCCEEDED);
  EXPECT_EQ(server_.result(job), before);
}

TEST_F(StoredResults, TakesAStoredMeshUnlessItIsToMakeItAnew) {
  server_.start();
  v1::Job wanted = server_.ball(8);
  const v1::Job first = server_.create(wanted);
  EXPECT_FALSE(server_.wait(first).cached());
  const v1::Job second = server_.create(wanted);
  EXPECT_TRUE(server_.wait(second).cached());
  EXPECT_EQ(server_.result(second), server_.result(first));
  wanted.set_skip_cache(true);
  const v1::Job third = server_.wait(server_.create(wanted));
  EXPECT_FALSE(third.cached());
  EXPECT_EQ(third.determinism_alarms(), 0);
  EXPECT_EQ(server_.result(third), server_.result(first));
}

/// Messages of a stream whose header says `cached`, and would be those of any other if it did
/// not.
std::vector<std::string> as_if_made(std::vector<std::string> messages) {
  v1::MeshEvent header;
  if (messages.empty() || !header.ParseFromString(messages[0])) return {};
  EXPECT_TRUE(header.header().cached());
  header.mutable_header()->clear_cached();
  messages[0] = header.SerializeAsString();
  return messages;
}

TEST_F(StoredResults, ServesStreamsFromAStoredMeshByteForByte) {
  server_.start();
  v1::Job job = server_.create(server_.ball(16));
  const v1::Job done = server_.wait(job);
  ASSERT_EQ(done.state(), v1::JOB_STATE_SUCCEEDED);
  const auto made = server_.stream(job);
  EXPECT_EQ(as_if_made(server_.any_stream(job)), made);
  EXPECT_EQ(as_if_made(server_.any_stream(job, 5, 7)), server_.stream(job, 5, 7));
  // In other words, and without the grid.
  const v1::MeshRequest canonical = done.header().canonical_request();
  job.mutable_mesh()->set_spacing(canonical.spacing());
  EXPECT_EQ(as_if_made(server_.any_stream(job)), made);
  fs::remove_all(server_.folder.file("store/grids"));
  server_.start();
  job.mutable_mesh()->clear_spacing();
  EXPECT_EQ(as_if_made(server_.any_stream(job)), made);
  server_.stream(job);
  EXPECT_EQ(reason_of(status_), "tetstream/GRID_NOT_FOUND");
}

TEST_F(StoredResults, MakesTheDamagedChunksOfAStreamThatIsResumed) {
  server_.start();
  const v1::Job job = server_.create(server_.ball(16));
  ASSERT_EQ(server_.wait(job).state(), v1::JOB_STATE_SUCCEEDED);
  const auto made = server_.stream(job);
  for (const fs::path& chunk : stored_chunks()) {
    std::fstream(chunk, std::ios::in | std::ios::out | std::ios::binary).seekp(5000) << "?!";
  }
  server_.any_stream(job);
  EXPECT_EQ(status_.error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_EQ(reason_of(status_), "tetstream/CHUNK_DAMAGED");
  EXPECT_EQ(server_.any_stream(job), made);
}

TEST_F(StoredResults, EvictsNoMeshThatIsBeingRead) {
  server_.start({"--result-bytes", std::to_string(30 << 20), "--job-lease-seconds", "600",
                 "--stall-seconds", "3600"});
  const v1::Job large = server_.create(server_.ball(32));  // 29 MB
  ASSERT_EQ(server_.wait(large).state(), v1::JOB_STATE_SUCCEEDED);
  grpc::ClientContext context;
  v1::StreamMeshRequest request;
  *request.mutable_mesh() = large.mesh();
  const auto reader = server_.meshes->StreamMesh(&context, request);
  v1::MeshEvent event;
  while (reader->Read(&event) && !event.has_header()) {  // progress, where opening takes long
  }
  ASSERT_TRUE(event.has_header());
  EXPECT_TRUE(event.header().cached());
  const std::int64_t chunks = event.header().chunk_count();
  v1::Job wanted = server_.ball(16);
  wanted.set_max_attempts(1);
  const v1::Job small = server_.create(wanted);
  // It waits, and uses up none of its attempts.
  ASSERT_TRUE(eventually([&] { return server_.get(small).has_last_give_back(); }));
  EXPECT_THAT(server_.get(small).last_give_back().message(), testing::HasSubstr("no room for"));
  for (std::int64_t i = 0; i < chunks; ++i)
    ASSERT_TRUE(reader->Read(&event) && event.has_chunk());
  ASSERT_TRUE(reader->Read(&event) && event.has_trailer());
  EXPECT_TRUE(reader->Finish().ok());
  EXPECT_EQ(server_.wait(small).state(), v1::JOB_STATE_SUCCEEDED);
}

/// A chunk has half a mebibyte.
constexpr std::uint64_t kLessThanAChunk = 100'000, kTwoChunks = 1 << 20;

TEST_F(StoredResults, BeginNoMeshThatFindsNoRoomBesideOneThatIsBeingMade) {
  const v1::Job begun = unfinished({20}).at(0);
  const v1::Job next = server_.create(server_.ball(19));
  const std::uint64_t stored = stored_bytes();
  start_with_room(stored + kLessThanAChunk);  // so that the first cannot go on, either
  ASSERT_TRUE(eventually([&] { return server_.get(next).has_last_give_back(); }));
  EXPECT_THAT(server_.get(next).last_give_back().message(),
              testing::HasSubstr("other jobs are making"));
  EXPECT_FALSE(server_.get(next).has_header());
  // As long as it looks it keeps what was counted of it.
  const fs::path plans = server_.folder.file("store/results/default/plans");
  const auto long_ago = fs::file_time_type::clock::now() - std::chrono::hours(2);
  for (const auto& plan : fs::directory_iterator(plans)) {
    fs::last_write_time(plan, long_ago);
  }
  ASSERT_TRUE(eventually([&] {
    return std::ranges::any_of(fs::directory_iterator(plans), [&](const auto& plan) {
      return plan.last_write_time() > long_ago + std::chrono::hours(1);
    });
  }));
  start_with_room(stored + kTwoChunks);
  ASSERT_EQ(server_.wait(next).state(), v1::JOB_STATE_SUCCEEDED);
  EXPECT_EQ(server_.get(begun).state(), v1::JOB_STATE_SUCCEEDED);
  EXPECT_FALSE(server_.result(next).empty());
  EXPECT_TRUE(status_.ok()) << status_.error_message();
}

TEST_F(StoredResults, AreNotEvictedForAWorkerOfAnotherStoresJobs) {
  const v1::Job job = unfinished({16}).at(0);
  const std::uint64_t stored = stored_bytes();
  JobServer other(TETSTREAMD_PATH);
  other.start({"--job-workers", "0"});
  const auto worker = server_.start_worker({"--jobs", other.folder.file("store/jobs.sqlite"),
                                            "--result-bytes", std::to_string(kLessThanAChunk)});
  ASSERT_TRUE(eventually(
      [&] { return worker->err().find("worker_quarantined") != std::string::npos; }));
  EXPECT_THAT(worker->err(), testing::HasSubstr("results_not_swept"));
  EXPECT_EQ(stored_bytes(), stored);
  EXPECT_EQ(server_.get(job).state(), v1::JOB_STATE_QUEUED);
}

TEST_F(StoredResults, EndTheYoungerOfTwoJobsThatWaitForEachOthersRoom) {
  const std::vector<v1::Job> jobs = unfinished({20, 19});
  const v1::Job &older = jobs[0], &younger = jobs[1];
  start_with_room(stored_bytes() + kLessThanAChunk);
  const v1::Job ended = server_.wait(younger);
  ASSERT_EQ(ended.state(), v1::JOB_STATE_FAILED);
  EXPECT_THAT(ended.error().message(), testing::HasSubstr("retry the job when they are"));
  EXPECT_THAT(ended.error().details(0).value(), testing::HasSubstr("RESULTS_HELD_BY_JOBS"));
  ASSERT_EQ(server_.wait(older).state(), v1::JOB_STATE_SUCCEEDED);
  EXPECT_FALSE(server_.result(older).empty());
  EXPECT_TRUE(status_.ok()) << status_.error_message();
  // Which it can be now.
  EXPECT_NE(server_.retry(younger).state(), v1::JOB_STATE_FAILED);
  EXPECT_EQ(server_.wait(younger).state(), v1::JOB_STATE_SUCCEEDED);
  EXPECT_FALSE(server_.result(younger).empty());
  EXPECT_TRUE(status_.ok()) << status_.error_message();
}

}  // namespace
}  // namespace tet::test
