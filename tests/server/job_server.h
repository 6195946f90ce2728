// A real tetstreamd that does jobs, for whoever kills it.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "client/library/mesh_client.h"
#include "tests/server/plain_channel.h"
#include "tests/server/port_file.h"
#include "tests/server/program.h"
#include "tests/server/test_folder.h"
#include "tests/server/until_healthy.h"
#include "tests/support/vdb_fixtures.h"
#include "tetstream/v1/grids.grpc.pb.h"
#include "tetstream/v1/jobs.grpc.pb.h"
#include "tetstream/v1/meshes.grpc.pb.h"

namespace tet::test {

namespace v1 = ::tetstream::v1;

constexpr int kMostAttempts = 100;

/// One store, and a server that may be started on it again and again. Calls leave how they
/// ended in `status`.
class JobServer {
 public:
  explicit JobServer(std::string program) : program_(std::move(program)) {}

  /// A server that was running is killed first. Leases are of one second unless `options` say
  /// otherwise, so that what a killed worker held is soon another's.
  void start(const std::vector<std::string>& options = {}) {
    kill();
    const std::string port_file = folder.file("port");
    std::filesystem::remove(port_file);
    process = run({"--listen", "127.0.0.1:0", "--port-file", port_file}, options);
    const std::string port = port_in(port_file);
    if (port.empty()) throw std::runtime_error("no server: " + process->err());
    connect("127.0.0.1:" + port);
  }

  /// A worker beside the server.
  std::unique_ptr<Program> start_worker(std::vector<std::string> options = {}) {
    return run({"worker"}, options);
  }

  void kill() { process.reset(); }

  /// A job for the uniform mesh of a ball, about 50 radius^3 tets.
  v1::Job ball(int radius) {
    const std::string path = folder.file("ball" + std::to_string(radius) + ".vdb");
    if (!std::filesystem::exists(path)) write_fixture("sphere", 1.0 / radius, path);
    v1::Job job = mesh_of(path);
    job.mutable_mesh()->set_levels(0);
    return job;
  }

  /// A job for a mesh that no limit refuses and that takes most of a minute to count: the
  /// surface of random signs goes through nearly every brick.
  v1::Job slow_to_count() {
    const std::string path = folder.file("random_signs.vdb");
    if (!std::filesystem::exists(path)) write_fixture("random-signs", 1, path);
    v1::Job job = mesh_of(path);
    job.mutable_mesh()->set_spacing(0.075);
    return job;
  }

  /// From now on calls that create, get, wait for or cancel jobs, and uploads, are made with
  /// this token.
  void use_token(const std::string& token) {
    token_ = token;
    ChannelOptions options;
    options.token = token;
    client = *MeshClient::connect(address_, options);
  }

  /// With as many attempts as may be, unless the job says how many: a worker that gets no
  /// processor for a second loses its leases, and is not to blame. Asks again where the server
  /// says that its disk has not answered for seconds, as our client does.
  v1::Job create(const v1::Job& job, const std::string& request_id = "") {
    v1::CreateJobRequest request;
    *request.mutable_job() = job;
    if (!job.has_max_attempts()) request.mutable_job()->set_max_attempts(kMostAttempts);
    request.set_request_id(request_id);
    v1::Job created;
    status = asked_until_healthy([&] {
      grpc::ClientContext context;
      authorize(context);
      return jobs->CreateJob(&context, request, &created);
    });
    return created;
  }

  v1::Job get(const v1::Job& job) { return call(&v1::JobService::Stub::GetJob, job); }
  v1::Job cancel(const v1::Job& job) { return call(&v1::JobService::Stub::CancelJob, job); }
  v1::Job retry(const v1::Job& job) { return call(&v1::JobService::Stub::RetryJob, job); }
  v1::Job wait(const v1::Job& job) { return call(&v1::JobService::Stub::WaitJob, job); }

  using Enough = std::function<bool(const v1::JobEvent&)>;
  static bool has_a_shard(const v1::JobEvent& event) {
    return event.change() == v1::JOB_CHANGE_SHARD_DONE;
  }
  static bool is_finished(const v1::JobEvent& event) {
    return event.change() == v1::JOB_CHANGE_FINISHED;
  }

  /// A job's events up to the first after which it is `enough`.
  std::vector<v1::JobEvent> watch(const v1::Job& job,
                                  const Enough& enough,
                                  std::int64_t after = 0) {
    grpc::ClientContext context;
    v1::WatchJobsRequest request;
    request.set_name(job.name());
    request.set_after_revision(after);
    const auto reader = jobs->WatchJobs(&context, request);
    std::vector<v1::JobEvent> events;
    for (v1::JobEvent event; reader->Read(&event);) {
      events.push_back(event);
      if (!enough(event)) continue;
      context.TryCancel();
      return events;
    }
    status = reader->Finish();
    return events;
  }

  /// The messages of a job's result, as their bytes.
  std::vector<std::string> result(const v1::Job& job,
                                  std::int64_t start = 0,
                                  std::int64_t end = 0) {
    grpc::ClientContext context;
    v1::ReadJobResultRequest request;
    request.set_name(job.name());
    request.set_start_chunk(start);
    request.set_end_chunk(end);
    return messages(jobs->ReadJobResult(&context, request));
  }

  /// The messages of a stream of the mesh, made anew, without progress.
  std::vector<std::string> stream(const v1::Job& job,
                                  std::int64_t start = 0,
                                  std::int64_t end = 0) {
    return stream(job, start, end, true);
  }

  /// The messages of a stream that may come from a stored result.
  std::vector<std::string> any_stream(const v1::Job& job,
                                      std::int64_t start = 0,
                                      std::int64_t end = 0) {
    return stream(job, start, end, false);
  }

  TestFolder folder;
  std::unique_ptr<Program> process;
  std::unique_ptr<v1::JobService::Stub> jobs;
  std::unique_ptr<v1::MeshService::Stub> meshes;
  std::unique_ptr<v1::GridService::Stub> grids;
  std::unique_ptr<MeshClient> client;
  grpc::Status status;

 private:
  /// A job for a mesh of the file, which is uploaded.
  v1::Job mesh_of(const std::string& path) {
    const auto name = client->upload_file(path, {}, never_);
    if (!name.ok()) throw std::runtime_error(name.status().ToString());
    v1::Job job;
    job.mutable_mesh()->set_name(*name);
    return job;
  }

  std::unique_ptr<Program> run(std::vector<std::string> arguments,
                               const std::vector<std::string>& options) {
    arguments.insert(arguments.begin(), program_);
    arguments.insert(arguments.end(), options.begin(), options.end());
    return std::make_unique<Program>(
        folder, arguments,
        std::map<std::string, std::string>{{"TETSTREAM_STORE", folder.file("store")},
                                           {"TETSTREAM_THREADS", "2"},
                                           {"TETSTREAM_JOB_LEASE_SECONDS", "1"}});
  }

  std::vector<std::string> stream(const v1::Job& job,
                                  std::int64_t start,
                                  std::int64_t end,
                                  bool skip_cache) {
    grpc::ClientContext context;
    v1::StreamMeshRequest request;
    *request.mutable_mesh() = job.mesh();
    request.set_skip_cache(skip_cache);
    request.set_start_chunk(start);
    request.set_end_chunk(end);
    return messages(meshes->StreamMesh(&context, request));
  }

  void authorize(grpc::ClientContext& context) const {
    if (!token_.empty()) context.AddMetadata("authorization", "Bearer " + token_);
  }

  void connect(const std::string& address) {
    address_ = address;
    const auto channel = plain_channel(address);
    jobs = v1::JobService::NewStub(channel);
    meshes = v1::MeshService::NewStub(channel);
    grids = v1::GridService::NewStub(channel);
    client = MeshClient::connect(address);
  }

  template <class Request>
  v1::Job call(grpc::Status (v1::JobService::Stub::*method)(grpc::ClientContext*,
                                                            const Request&,
                                                            v1::Job*),
               const v1::Job& job) {
    grpc::ClientContext context;
    authorize(context);
    Request request;
    request.set_name(job.name());
    v1::Job response;
    status = (jobs.get()->*method)(&context, request, &response);
    return response;
  }

  template <class Reader>
  std::vector<std::string> messages(Reader reader) {
    std::vector<std::string> all;
    for (v1::MeshEvent event; reader->Read(&event);) {
      if (!event.has_progress()) all.push_back(event.SerializeAsString());
    }
    status = reader->Finish();
    return all;
  }

  const std::string program_;
  std::string address_, token_;
  Cancellation never_;
};

}  // namespace tet::test
