#include "client/library/job_client.h"

#include <utility>

#include "client/library/connection.h"
#include "client/library/receive_mesh.h"
#include "proto/wire/serialized.h"
#include "proto/wire/transport.h"
#include "tetstream/v1/jobs.grpc.pb.h"

namespace tet {

namespace {

using Stub = v1::JobService::Stub;

/// An attempt to watch that a server had begun, and that lasted so long, was served, although
/// nothing may have changed meanwhile.
constexpr std::chrono::seconds kServedFor{30};

/// A request that holds nothing but a job's name.
template <class Request>
Request named(const std::string& name) {
  Request request;
  request.set_name(name);
  return request;
}

/// How one watch ended.
struct WatchEnd {
  absl::Status status;
  bool left = false;   ///< `see` has seen enough
  bool begun = false;  ///< by the server itself, and not a proxy
};

WatchEnd watch_once(const ServerChannel& server,
                    v1::WatchJobsRequest& request,
                    const std::function<bool(const v1::JobEvent&)>& see,
                    const Cancellation& cancellation) {
  Stub stub(server.channel());
  ClientCall call(server, cancellation);
  const auto stream = stub.WatchJobs(&call.context(), request);
  WatchEnd end;
  for (v1::JobEvent event; !end.left && stream->Read(&event);) {
    request.set_after_revision(event.revision());
    end.left = !see(event);
  }
  if (end.left) call.context().TryCancel();
  end.status = call.result(stream->Finish());
  end.begun = call.context().GetServerInitialMetadata().contains(kWatchBegun);
  return end;
}

}  // namespace

JobClient::JobClient(std::shared_ptr<Connection> connection, Clock clock)
    : connection_(std::move(connection)), clock_(std::move(clock)) {}

JobClient::~JobClient() = default;

absl::StatusOr<v1::Job> JobClient::create(const v1::Job& job,
                                          const std::string& request_id,
                                          const Cancellation& cancellation) {
  v1::CreateJobRequest request;
  *request.mutable_job() = job;
  request.set_request_id(request_id);
  return connection_->call(&Stub::CreateJob, request, cancellation);
}

absl::StatusOr<v1::Job> JobClient::get(const std::string& name,
                                       const Cancellation& cancellation) {
  return connection_->call(&Stub::GetJob, named<v1::GetJobRequest>(name), cancellation);
}

absl::StatusOr<v1::Job> JobClient::cancel(const std::string& name,
                                          const Cancellation& cancellation) {
  return connection_->call(&Stub::CancelJob, named<v1::CancelJobRequest>(name), cancellation);
}

absl::StatusOr<v1::Job> JobClient::retry(const std::string& name,
                                         const Cancellation& cancellation) {
  return connection_->call(&Stub::RetryJob, named<v1::RetryJobRequest>(name), cancellation);
}

absl::Status JobClient::remove(const std::string& name, const Cancellation& cancellation) {
  return connection_->call(&Stub::DeleteJob, named<v1::DeleteJobRequest>(name), cancellation)
      .status();
}

absl::StatusOr<v1::ListJobsResponse> JobClient::list(const v1::ListJobsRequest& request,
                                                     const Cancellation& cancellation) {
  return connection_->call(&Stub::ListJobs, request, cancellation);
}

absl::StatusOr<std::int64_t> JobClient::revision(const Cancellation& cancellation) {
  v1::ListJobsRequest request;
  request.set_page_size(1);
  const auto page = list(request, cancellation);
  if (!page.ok()) return page.status();
  return page->revision();
}

absl::StatusOr<std::vector<v1::DeadShard>> JobClient::dead_shards(
    const std::string& name, const Cancellation& cancellation) {
  std::vector<v1::DeadShard> shards;
  auto request = named<v1::ListDeadShardsRequest>(name);
  do {
    auto page = connection_->call(&Stub::ListDeadShards, request, cancellation);
    if (!page.ok()) return page.status();
    for (v1::DeadShard& shard : *page->mutable_shards()) shards.push_back(std::move(shard));
    request.set_page_token(page->next_page_token());
  } while (!request.page_token().empty());
  return shards;
}

absl::StatusOr<v1::ListWorkersResponse> JobClient::workers(const Cancellation& cancellation) {
  v1::ListWorkersResponse all;
  v1::ListWorkersRequest request;
  do {
    const auto page = connection_->call(&Stub::ListWorkers, request, cancellation);
    if (!page.ok()) return page.status();
    all.MergeFrom(*page);
    request.set_page_token(page->next_page_token());
  } while (!request.page_token().empty());
  return all;
}

absl::Status JobClient::watch(const std::string& name,
                              std::int64_t after_revision,
                              const std::function<bool(const v1::JobEvent&)>& see,
                              const Cancellation& cancellation) {
  auto request = named<v1::WatchJobsRequest>(name);
  request.set_after_revision(after_revision);
  std::uint64_t served = 0;
  for (Retries retries = connection_->begin(cancellation);;) {
    const ServerChannel& server = connection_->server();
    const std::int64_t before = request.after_revision();
    const auto begun = clock_();
    const WatchEnd end = watch_once(server, request, see, cancellation);
    if (end.begun) connection_->answered();
    if (end.left || end.status.ok()) return absl::OkStatus();
    // An idle watch is cut off now and then by whatever is in between: such ends do not add up.
    const bool lasted = clock_() - begun >= kServedFor;
    if (request.after_revision() > before || (end.begun && lasted)) ++served;
    if (auto ended = connection_->again(retries, server, end.status, served); !ended.ok())
      return ended;
  }
}

absl::StatusOr<StreamedMesh> JobClient::read_result(const std::string& name,
                                                    const ClientProgress& progress,
                                                    const Cancellation& cancellation) {
  const auto request = [&name](const MeshReceiver& receiver) {
    auto rest = named<v1::ReadJobResultRequest>(name);
    rest.set_start_chunk(static_cast<std::int64_t>(receiver.next_chunk()));
    return serialized(rest);
  };
  return receive_mesh(*connection_,
                      {v1::JobService::service_full_name(), "ReadJobResult", request},
                      MeshReceiver(), progress, cancellation);
}

}  // namespace tet
