// Nobody learns what another namespace has.
#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/library/error_details.h"
#include "tests/server/open_upload.h"
#include "tests/server/reason_of.h"
#include "tests/server/service_fixture.h"
#include "tests/server/token_book.h"
#include "tests/server/until_healthy.h"
#include "tetstream/v1/jobs.grpc.pb.h"

namespace tet::test {
namespace {

constexpr char kAllScopes[] =
    "\"grids.read\", \"grids.write\", \"mesh\", \"jobs.read\", \"jobs.write\"";

class NamespacesTest : public ServiceTest {
 protected:
  NamespacesTest() {
    config_.tokens = tokens_.file();
    config_.jobs.clear();
    config_.job_workers = 0;
    for (const char* name : {"alice", "bob"}) tokens_.add(name, kAllScopes, name);
    start();
  }

  std::unique_ptr<MeshClient> client_of(const std::string& name) {
    ChannelOptions options;
    options.token = "secret-of-" + name;
    return *MeshClient::connect(server_->address(), options);
  }

  std::string upload(const std::string& name, const std::string& path) {
    const auto stored = client_of(name)->upload_file(path, {}, never_);
    EXPECT_TRUE(stored.ok()) << stored.status();
    return stored.value_or("");
  }

  /// What `name` gets for announcing a file of `size` bytes and sending no data.
  v1::UploadGridResponse announce(const std::string& name,
                                  const std::string& grid,
                                  std::size_t size) {
    OpenUpload upload(*grids_, grid, size, "secret-of-" + name);
    EXPECT_TRUE(upload.finish().ok());
    return upload.response();
  }

  TokenBook tokens_{folder_};
};

/// Every answer that could tell, as text.
std::vector<std::string> answers_about(MeshClient& client, const std::string& grid) {
  const Cancellation never;
  v1::MeshRequest request;
  request.set_name(grid);
  v1::MeshRequest leaf;
  leaf.mutable_scene()->add_nodes()->mutable_grid()->set_name(grid);
  // The call's own id differs from call to call.
  const auto told = [](const absl::Status& status) {
    return absl::StatusCodeToString(status.code()) + " " + reason_of_failure(status) + ": " +
           std::string(status.message());
  };
  return {told(client.grid_info(grid, never).status()),
          told(client.estimate(request, never).status()),
          told(client.estimate(leaf, never).status()),
          told(client.stream_mesh(request, {}, never).status()),
          std::to_string(client.list_grids(never)->size())};
}

TEST_F(NamespacesTest, AnswerAsIfTheyWereAlone) {
  const std::string alices = upload("alice", ball_file(8));
  ASSERT_TRUE(client_of("alice")->grid_info(alices, never_).ok());
  const auto bob = client_of("bob");
  const std::string never_stored = "grids/" + std::string(64, '0');
  std::vector<std::string> answers = answers_about(*bob, alices);
  for (std::string& answer : answers) {
    if (const auto at = answer.find(alices); at != std::string::npos) {
      answer.replace(at, alices.size(), never_stored);
    }
  }
  EXPECT_EQ(answers, answers_about(*bob, never_stored));
}

TEST_F(NamespacesTest, TakeAllBytesOfAFileThatAnotherHas) {
  const std::string path = ball_file(8);
  const std::size_t size = read_text(path).size();
  const std::string grid = upload("alice", path);
  EXPECT_TRUE(announce("alice", grid, size).complete());
  EXPECT_FALSE(announce("bob", grid, size).complete());
  EXPECT_EQ(announce("bob", grid, size).committed_size(), 0);
  std::uint64_t sent = 0;
  const ClientProgress progress{
      .upload = [&](std::uint64_t done, std::uint64_t) { sent = done; },
      .planning = {},
      .tets = {}};
  ASSERT_TRUE(client_of("bob")->upload_file(path, progress, never_).ok());
  EXPECT_EQ(sent, size);
}

TEST_F(NamespacesTest, LetOneUploadWhileAnotherDoes) {
  const std::string path = ball_file(8);
  OpenUpload alices(*grids_, upload("bob", path), 1000, "secret-of-alice");
  EXPECT_FALSE(upload("bob", path).empty());
  alices.cancel();
}

TEST_F(NamespacesTest, KeepNothingOfABaseThatAnotherHas) {
  const std::string base = upload("alice", ball_file(8));
  const std::string both = ball_file(9);
  upload("alice", both);
  v1::MeshRequest request;
  request.set_name(base);
  const auto earlier = client_of("alice")->stream_mesh(request, {}, never_);
  ASSERT_TRUE(earlier.ok()) << earlier.status();
  v1::StreamMeshRequest update;
  update.mutable_mesh()->set_name(upload("bob", both));
  update.set_base_mesh_id(earlier->mesh_id);
  update.set_base_name(base);
  grpc::ClientContext context;
  context.AddMetadata("authorization", "Bearer secret-of-bob");
  const auto reader = meshes_->StreamMesh(&context, update);
  v1::MeshEvent event;
  while (reader->Read(&event) && !event.has_header()) {
  }
  EXPECT_TRUE(event.has_header());
  EXPECT_FALSE(event.header().has_kept());
  context.TryCancel();
  reader->Finish();
}

TEST_F(NamespacesTest, GiveAMeshTheSameNameAndBytes) {
  const std::string path = ball_file(8);
  v1::MeshRequest request;
  request.set_name(upload("alice", path));
  upload("bob", path);
  const auto first = client_of("alice")->stream_mesh(request, {}, never_);
  const auto second = client_of("bob")->stream_mesh(request, {}, never_);
  ASSERT_TRUE(first.ok() && second.ok()) << first.status() << second.status();
  EXPECT_EQ(first->mesh_id, second->mesh_id);
  EXPECT_TRUE(
      std::ranges::equal(first->mesh.positions.bytes(), second->mesh.positions.bytes()));
  EXPECT_TRUE(std::ranges::equal(first->mesh.tets.bytes(), second->mesh.tets.bytes()));
}

TEST_F(NamespacesTest, SurviveARestart) {
  const std::string path = ball_file(8);
  const std::string grid = upload("alice", path);
  restart();
  EXPECT_TRUE(client_of("alice")->grid_info(grid, never_).ok());
  EXPECT_TRUE(absl::IsNotFound(client_of("bob")->grid_info(grid, never_).status()));
}

/// Makes a call in somebody's name.
template <class Request, class Response>
grpc::Status call_as(const std::string& name,
                     v1::JobService::Stub& jobs,
                     grpc::Status (v1::JobService::Stub::*method)(grpc::ClientContext*,
                                                                  const Request&,
                                                                  Response*),
                     const Request& request,
                     Response& response) {
  return asked_until_healthy([&] {
    grpc::ClientContext context;
    context.AddMetadata("authorization", "Bearer secret-of-" + name);
    return (jobs.*method)(&context, request, &response);
  });
}

TEST_F(NamespacesTest, SeeOnlyTheirOwnJobs) {
  const auto jobs = v1::JobService::NewStub(channel_);
  v1::CreateJobRequest create;
  create.mutable_job()->mutable_mesh()->set_name(upload("alice", ball_file(8)));
  v1::Job job, seen;
  using Stub = v1::JobService::Stub;
  ASSERT_TRUE(call_as("alice", *jobs, &Stub::CreateJob, create, job).ok());
  const grpc::Status not_bobs = call_as("bob", *jobs, &Stub::CreateJob, create, seen);
  EXPECT_EQ(reason_of(not_bobs), "tetstream/GRID_NOT_FOUND");
  const auto about_the_job = [&](const std::string& name, auto method, auto request) {
    request.set_name(job.name());
    return reason_of(call_as(name, *jobs, method, request, seen));
  };
  const std::string unknown = "tetstream/JOB_NOT_FOUND";
  EXPECT_EQ(about_the_job("bob", &Stub::GetJob, v1::GetJobRequest()), unknown);
  EXPECT_EQ(about_the_job("bob", &Stub::WaitJob, v1::WaitJobRequest()), unknown);
  EXPECT_EQ(about_the_job("bob", &Stub::CancelJob, v1::CancelJobRequest()), unknown);
  EXPECT_EQ(about_the_job("bob", &Stub::RetryJob, v1::RetryJobRequest()), unknown);
  EXPECT_EQ(about_the_job("alice", &Stub::RetryJob, v1::RetryJobRequest()),
            "tetstream/JOB_ACTIVE");
  v1::ListJobsResponse listed;
  EXPECT_TRUE(call_as("bob", *jobs, &Stub::ListJobs, v1::ListJobsRequest(), listed).ok());
  EXPECT_EQ(listed.jobs_size(), 0);
}

}  // namespace
}  // namespace tet::test
