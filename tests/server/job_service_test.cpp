// Batch jobs as clients meet them: a real tetstreamd, killed and started again.
#include <chrono>
#include <filesystem>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "proto/wire/transport.h"
#include "tests/server/job_server.h"
#include "tests/server/open_upload.h"
#include "tests/server/reason_of.h"
#include "tests/support/eventually.h"

namespace tet::test {
namespace {

namespace fs = std::filesystem;

class JobServiceTest : public testing::Test {
 protected:
  JobServer server_{TETSTREAMD_PATH};
  const grpc::Status& status_ = server_.status;
};

TEST_F(JobServiceTest, MakesWhatAStreamSendsByteForByte) {
  server_.start();
  const v1::Job job = server_.create(server_.ball(16));
  const v1::Job done = server_.wait(job);
  ASSERT_EQ(done.state(), v1::JOB_STATE_SUCCEEDED) << done.DebugString();
  EXPECT_EQ(done.progress().done_chunks(), done.header().chunk_count());
  EXPECT_FALSE(done.cached());
  const std::int64_t count = done.header().chunk_count();
  ASSERT_GT(count, 4);
  EXPECT_EQ(server_.result(job), server_.stream(job));
  EXPECT_EQ(server_.result(job, 1, 3), server_.stream(job, 1, 3));
  EXPECT_EQ(server_.result(job, count - 1, count), server_.stream(job, count - 1, count));
  EXPECT_TRUE(status_.ok());
  server_.result(job, 1, count + 1);
  EXPECT_EQ(reason_of(status_), "tetstream/CHUNK_RANGE");
}

TEST_F(JobServiceTest, MakesOneJobOfOneRequest) {
  server_.start({"--job-workers", "0"});
  v1::Job wanted = server_.ball(4);
  const v1::Job job = server_.create(wanted, "once");
  EXPECT_EQ(job.state(), v1::JOB_STATE_QUEUED);
  EXPECT_EQ(job.queue_position(), 0);
  EXPECT_EQ(server_.create(wanted, "once").name(), job.name());
  wanted.set_priority(1);
  server_.create(wanted, "once");
  EXPECT_EQ(reason_of(status_), "tetstream/REQUEST_ID_REUSED");
}

TEST_F(JobServiceTest, CountsALongQueueOnlyForWhoeverAsks) {
  server_.start({"--job-workers", "0"});
  const v1::Job wanted = server_.ball(4);
  constexpr int kCountedWhenMade = 1000;
  for (int i = 0; i < kCountedWhenMade; ++i) {
    ASSERT_EQ(server_.create(wanted).queue_position(), i);
  }
  EXPECT_EQ(server_.create(wanted).queue_position(), kCountedWhenMade);
  const v1::Job last = server_.create(wanted);
  EXPECT_FALSE(last.has_queue_position());
  EXPECT_EQ(server_.get(last).queue_position(), kCountedWhenMade + 1);
}

TEST_F(JobServiceTest, RefusesWhatOnlyTheServerMaySay) {
  server_.start({"--job-workers", "0"});
  v1::Job wanted = server_.ball(4);
  wanted.set_state(v1::JOB_STATE_SUCCEEDED);
  server_.create(wanted);
  EXPECT_EQ(status_.error_message(), "state is set by the server");
}

TEST_F(JobServiceTest, FinishesAJobAlthoughItIsKilledInTheMiddle) {
  server_.start({"--job-workers", "1"});
  const v1::Job job = server_.create(server_.ball(24));
  server_.watch(job, JobServer::has_a_shard);
  server_.process->send(SIGKILL);
  server_.process->wait();
  server_.start();
  const v1::Job done = server_.wait(job);
  ASSERT_EQ(done.state(), v1::JOB_STATE_SUCCEEDED) << done.DebugString();
  EXPECT_EQ(done.determinism_alarms(), 0);
  EXPECT_EQ(server_.result(job), server_.stream(job));
}

TEST_F(JobServiceTest, GivesItsShardsBackWhenItIsStopped) {
  server_.start({"--job-workers", "1", "--job-lease-seconds", "600", "--job-count-bricks",
                 "8388608"});  // all of it is one shard
  const v1::Job job = server_.create(server_.ball(24));
  server_.watch(job, JobServer::has_a_shard);
  server_.process->send(SIGTERM);
  EXPECT_EQ(server_.process->wait(), 0);
  server_.start();
  EXPECT_EQ(server_.wait(job).state(), v1::JOB_STATE_SUCCEEDED);
}

TEST_F(JobServiceTest, StopsAJobAndGoesOnWithItWhenAsked) {
  server_.start({"--job-workers", "0"});
  const v1::Job job = server_.create(server_.ball(8));
  server_.result(job);
  EXPECT_EQ(reason_of(status_), "tetstream/JOB_NOT_SUCCEEDED");
  const v1::Job cancelled = server_.cancel(job);
  EXPECT_EQ(cancelled.state(), v1::JOB_STATE_CANCELLED);
  EXPECT_EQ(cancelled.error().code(), grpc::StatusCode::CANCELLED);
  EXPECT_EQ(server_.wait(job).state(), v1::JOB_STATE_CANCELLED);
  EXPECT_EQ(server_.retry(job).state(), v1::JOB_STATE_QUEUED);
  server_.start();
  EXPECT_EQ(server_.wait(job).state(), v1::JOB_STATE_SUCCEEDED);
  server_.retry(job);
  EXPECT_EQ(reason_of(status_), "tetstream/JOB_SUCCEEDED");
}

TEST_F(JobServiceTest, KeepsTheGridOfAJobUntilItIsFinished) {
  server_.start();
  const v1::Job wanted = server_.ball(4);
  const auto size = fs::file_size(server_.folder.file("ball4.vdb"));
  const std::vector<std::string> tight = {"--job-workers", "0", "--store-bytes",
                                          std::to_string(size + 100)};
  server_.start(tight);
  const v1::Job job = server_.create(wanted);
  const std::string other(200, 'x');
  const auto upload = [&] {
    return upload_text(*server_.grids, grid_name_of(other), other, other.size()).status;
  };
  EXPECT_EQ(reason_of(upload()), "tetstream/STORE_HELD_BY_JOBS");
  server_.start(tight);
  EXPECT_EQ(reason_of(upload()), "tetstream/STORE_HELD_BY_JOBS");
  EXPECT_EQ(server_.cancel(job).state(), v1::JOB_STATE_CANCELLED);
  EXPECT_TRUE(upload().ok());
  server_.retry(job);
  EXPECT_EQ(reason_of(status_), "tetstream/GRID_NOT_FOUND");
}

v1::Job with_fields(JobServer& server, v1::Job job) {
  const std::string path = server.folder.file("fields.vdb");
  write_fixture("fields", 0.25, path);
  v1::Field& field = *job.mutable_mesh()->add_fields();
  field.set_grid(server.client->upload_file(path, {}, Cancellation()).value());
  field.set_grid_name("velocity");
  return job;
}

TEST_F(JobServiceTest, MakesTheFieldsThatAStreamSends) {
  server_.start();
  const v1::Job job = server_.create(with_fields(server_, server_.ball(12)));
  ASSERT_EQ(server_.wait(job).state(), v1::JOB_STATE_SUCCEEDED);
  const std::vector<std::string> result = server_.result(job);
  EXPECT_EQ(result, server_.stream(job));
  v1::MeshEvent header;
  ASSERT_TRUE(header.ParseFromString(result.front()));
  EXPECT_EQ(header.header().fields(0).name(), "velocity");
  EXPECT_EQ(header.header().fields(0).components(), 3);
}

/// A ball with another one taken off it; both are stored.
v1::Job scene_job(JobServer& server) {
  v1::Job job;
  v1::Scene& scene = *job.mutable_mesh()->mutable_scene();
  for (const int radius : {4, 5}) {
    v1::SceneNode& node = *scene.add_nodes();
    node.set_name(std::to_string(radius));
    node.mutable_grid()->set_name(server.ball(radius).mesh().name());
  }
  v1::SceneNode& moved = *scene.add_nodes();
  moved.set_name("moved");
  moved.mutable_transform()->set_of("5");
  for (const double along : {1.0, 0.0, 0.0}) moved.mutable_transform()->add_translation(along);
  v1::SceneNode& moon = *scene.add_nodes();
  for (const char* name : {"4", "moved"}) moon.mutable_difference()->add_of(name);
  return job;
}

TEST_F(JobServiceTest, MakesScenesOfStoredGrids) {
  server_.start();
  const v1::Job job = server_.create(scene_job(server_));
  const v1::Job done = server_.wait(job);
  ASSERT_EQ(done.state(), v1::JOB_STATE_SUCCEEDED) << done.DebugString();
  EXPECT_EQ(server_.result(job), server_.stream(job));
  const auto cached = server_.client->stream_mesh(job.mesh(), {}, Cancellation());
  ASSERT_TRUE(cached.ok()) << cached.status();
  EXPECT_EQ(cached->mesh_id, done.header().mesh_id());
}

TEST_F(JobServiceTest, KeepsEveryGridOfAScenesJob) {
  server_.start();
  const v1::Job wanted = scene_job(server_);
  const auto size = fs::file_size(server_.folder.file("ball4.vdb")) +
                    fs::file_size(server_.folder.file("ball5.vdb"));
  server_.start({"--job-workers", "0", "--store-bytes", std::to_string(size + 100)});
  const v1::Job job = server_.create(wanted);
  const std::string other(200, 'x');
  const auto upload = [&] {
    return upload_text(*server_.grids, grid_name_of(other), other, other.size()).status;
  };
  EXPECT_EQ(reason_of(upload()), "tetstream/STORE_HELD_BY_JOBS");
  server_.cancel(job);
  EXPECT_TRUE(upload().ok());
  server_.create(wanted);
  EXPECT_EQ(reason_of(status_), "tetstream/GRID_NOT_FOUND");
}

TEST_F(JobServiceTest, TellsHowManyJobsANamespaceMayHaveAndRefusesMore) {
  server_.start({"--job-workers", "0", "--max-namespace-jobs", "1"});
  EXPECT_EQ(server_.client->capabilities(Cancellation())->limits().max_namespace_jobs(), 1);
  const v1::Job wanted = server_.ball(4);
  const v1::Job job = server_.create(wanted);
  server_.create(wanted);
  EXPECT_EQ(reason_of(status_), "tetstream/QUOTA_EXCEEDED");
  google::rpc::Status details;
  ASSERT_TRUE(details.ParseFromString(status_.error_details()));
  google::rpc::QuotaFailure failure;
  ASSERT_TRUE(details.details(1).UnpackTo(&failure));
  EXPECT_EQ(failure.violations(0).subject(), "namespace:default");
  server_.cancel(job);
  server_.create(wanted);
  EXPECT_TRUE(status_.ok());
}

TEST_F(JobServiceTest, SaysWhyAJobWasNotDoneInTime) {
  server_.start({"--job-workers", "0"});
  v1::Job wanted = server_.ball(4);
  wanted.mutable_ttl()->set_nanos(1'000'000);
  const v1::Job expired = server_.wait(server_.create(wanted));
  EXPECT_EQ(expired.state(), v1::JOB_STATE_EXPIRED);
  EXPECT_EQ(expired.error().code(), grpc::StatusCode::DEADLINE_EXCEEDED);
}

TEST_F(JobServiceTest, SaysWhyAMeshCannotBeMade) {
  server_.start({"--job-lease-seconds", "600"});  // none is lost, however slow the disk is
  v1::Job wanted = server_.ball(4);
  wanted.mutable_mesh()->set_iso(-100);
  const v1::Job failed = server_.wait(server_.create(wanted));
  EXPECT_EQ(failed.state(), v1::JOB_STATE_FAILED);
  google::rpc::ErrorInfo info;
  ASSERT_GT(failed.error().details_size(), 0);
  ASSERT_TRUE(failed.error().details(0).UnpackTo(&info));
  EXPECT_EQ(info.reason(), "NOTHING_TO_MESH");
  grpc::ClientContext context;
  v1::ListDeadShardsRequest request;
  request.set_name(failed.name());
  v1::ListDeadShardsResponse dead;
  EXPECT_TRUE(server_.jobs->ListDeadShards(&context, request, &dead).ok());
  ASSERT_EQ(dead.shards_size(), 1);
  EXPECT_EQ(dead.shards(0).attempts(), 1);
}

TEST_F(JobServiceTest, TellsOfItsWorkersAndWhatTheyHold) {
  server_.start({"--job-workers", "1", "--job-lease-seconds", "600"});
  const v1::Job job = server_.create(server_.slow_to_count());
  v1::ListWorkersResponse workers;
  const auto is_held = [&] {
    grpc::ClientContext context;
    workers.Clear();
    EXPECT_TRUE(server_.jobs->ListWorkers(&context, {}, &workers).ok());
    return workers.workers_size() == 1 && workers.workers(0).shards_size() > 0;
  };
  ASSERT_TRUE(eventually(is_held));
  const v1::Worker& worker = workers.workers(0);
  EXPECT_THAT(worker.name(), testing::EndsWith(":" + std::to_string(server_.process->pid())));
  EXPECT_EQ(worker.algorithm_version(),
            server_.client->capabilities(Cancellation())->algorithm_version());
  EXPECT_FALSE(worker.lost());
  EXPECT_FALSE(worker.has_trouble());
  EXPECT_GE(worker.leased_shards(), 1);
  EXPECT_EQ(worker.shards(0).job(), job.name());
  EXPECT_EQ(worker.shards(0).attempt(), 1);
  EXPECT_GT(worker.shards(0).lease_end_time().seconds(), worker.seen_time().seconds() - 60);
  EXPECT_EQ(workers.next_page_token(), "");
  server_.cancel(job);
}

TEST_F(JobServiceTest, RefusesAPageOfWorkersThatItDidNotName) {
  server_.start({"--job-workers", "0"});
  // No Base64, a zero byte, no UTF-8, and too long for a name.
  for (const std::string& token :
       {std::string("?"), std::string("AA"), std::string("_w"), std::string(200, 'A')}) {
    grpc::ClientContext context;
    v1::ListWorkersRequest request;
    request.set_page_token(token);
    v1::ListWorkersResponse workers;
    const grpc::Status refused = server_.jobs->ListWorkers(&context, request, &workers);
    EXPECT_EQ(reason_of(refused), "tetstream/INVALID_FIELD") << token;
  }
}

TEST_F(JobServiceTest, TellsEachChangeOnceAlsoToWhoeverComesBack) {
  server_.start();
  const v1::Job job = server_.create(server_.ball(8));
  const auto all = server_.watch(job, JobServer::is_finished);
  ASSERT_GT(all.size(), 3U);
  EXPECT_EQ(all.front().change(), v1::JOB_CHANGE_CREATED);
  for (std::size_t i = 1; i < all.size(); ++i) {
    EXPECT_GT(all[i].revision(), all[i - 1].revision());
    EXPECT_EQ(all[i].version(), all[i - 1].version() + 1);
  }
  const auto rest = server_.watch(job, JobServer::is_finished, all[1].revision());
  ASSERT_EQ(rest.size(), all.size() - 2);
  EXPECT_EQ(rest[0].revision(), all[2].revision());
}

TEST_F(JobServiceTest, SaysThatAWatchHasBegunBeforeAnythingHappens) {
  server_.start({"--job-workers", "0"});
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + kGenerousEnd);
  const auto reader = server_.jobs->WatchJobs(&context, v1::WatchJobsRequest());
  reader->WaitForInitialMetadata();
  EXPECT_TRUE(context.GetServerInitialMetadata().contains(kWatchBegun));
  context.TryCancel();
  EXPECT_EQ(reader->Finish().error_code(), grpc::StatusCode::CANCELLED);
}

TEST_F(JobServiceTest, EndsAWatchWhenItsJobIsDeleted) {
  server_.start();
  const v1::Job job = server_.create(server_.ball(4));
  ASSERT_EQ(server_.wait(job).state(), v1::JOB_STATE_SUCCEEDED);
  std::thread deletes([&] {
    grpc::ClientContext context;
    v1::DeleteJobRequest request;
    request.set_name(job.name());
    google::protobuf::Empty nothing;
    EXPECT_TRUE(server_.jobs->DeleteJob(&context, request, &nothing).ok());
  });
  const auto events = server_.watch(job, [](const auto&) { return false; });
  deletes.join();
  EXPECT_TRUE(status_.ok()) << status_.error_message();
  ASSERT_FALSE(events.empty());
  EXPECT_EQ(events.back().change(), v1::JOB_CHANGE_DELETED);
  server_.get(job);
  EXPECT_EQ(reason_of(status_), "tetstream/JOB_NOT_FOUND");
}

TEST_F(JobServiceTest, ListsJobsPageByPage) {
  server_.start({"--job-workers", "0"});
  const v1::Job wanted = server_.ball(4);
  std::vector<std::string> created;
  for (int i = 0; i < 3; ++i) created.push_back(server_.create(wanted).name());
  std::vector<std::string> listed;
  v1::ListJobsRequest request;
  request.set_page_size(2);
  do {
    grpc::ClientContext context;
    v1::ListJobsResponse page;
    ASSERT_TRUE(server_.jobs->ListJobs(&context, request, &page).ok());
    for (const v1::Job& job : page.jobs()) {
      listed.push_back(job.name());
      EXPECT_EQ(job.mesh().name(), wanted.mesh().name());
    }
    request.set_page_token(page.next_page_token());
  } while (!request.page_token().empty());
  std::reverse(created.begin(), created.end());
  EXPECT_EQ(listed, created);
}

// All of the count is one shard, and the worker's next heartbeat is minutes away. Work that
// went on to its end would be refused as LEASE_LOST; work that was stopped says that it was
// cancelled.
TEST_F(JobServiceTest, StopsTheWorkOfACancelledJobSoon) {
  server_.start(
      {"--job-workers", "1", "--job-lease-seconds", "600", "--job-count-bricks", "8388608"});
  const v1::Job job = server_.create(server_.slow_to_count());
  server_.watch(
      job, [](const v1::JobEvent& event) { return event.change() == v1::JOB_CHANGE_STARTED; });
  const v1::Job next = server_.create(server_.ball(4));
  ASSERT_EQ(server_.cancel(job).state(), v1::JOB_STATE_CANCELLED);
  EXPECT_EQ(server_.wait(next).state(), v1::JOB_STATE_SUCCEEDED);
  const auto log = [&] { return server_.process->err(); };
  ASSERT_TRUE(eventually([&] { return log().find("shard_lost") != std::string::npos; }));
  EXPECT_THAT(log(), testing::HasSubstr(R"("shard":0,"reason":"CANCELLED")"));
}

TEST_F(JobServiceTest, LetsWorkersDoItAlthoughOneIsKilled) {
  server_.start({"--job-workers", "0"});
  auto killed = server_.start_worker({"--job-workers", "1"});
  const v1::Job job = server_.create(server_.ball(24));
  server_.watch(job, JobServer::has_a_shard);
  killed.reset();
  const auto other = server_.start_worker();
  ASSERT_EQ(server_.wait(job).state(), v1::JOB_STATE_SUCCEEDED);
  EXPECT_EQ(server_.result(job), server_.stream(job));
  other->send(SIGTERM);
  EXPECT_EQ(other->wait(), 0);
}

TEST_F(JobServiceTest, LetsAWorkerGoWhenNothingIsLeftToDo) {
  server_.start({"--job-workers", "0"});
  const v1::Job job = server_.create(server_.ball(8));
  const auto worker = server_.start_worker({"--job-idle-seconds", "1"});
  EXPECT_EQ(worker->wait(), 0);
  EXPECT_EQ(server_.get(job).state(), v1::JOB_STATE_SUCCEEDED);
}

}  // namespace
}  // namespace tet::test
