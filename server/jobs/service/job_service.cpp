#include "server/jobs/service/job_service.h"

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

#include <absl/strings/escaping.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_split.h>

#include "proto/convert/status.h"
#include "server/jobs/service/job_messages.h"
#include "server/jobs/service/job_wait.h"
#include "server/jobs/service/job_watch.h"
#include "server/jobs/service/result_stream.h"

namespace tet {

namespace {

// After this time the server may know that there is room again.
constexpr absl::Duration kAskAgain = absl::Seconds(2);

// Counting takes as long as the queue: whoever submits thousands does not wait for it.
constexpr std::int64_t kMostCounted = 1000;

/// A job as GetJob and CreateJob tell it, with its place in the queue if no more than `most`
/// come before it.
absl::Status tell(JobContext& shared,
                  const absl::StatusOr<Job>& job,
                  v1::Job& response,
                  std::int64_t most = INT64_MAX - 1) {
  if (!job.ok()) return job.status();
  to_proto(*job, true, response);
  if (job->state != JobState::kQueued) return absl::OkStatus();
  const auto position = shared.jobs.queue_position(job->id, most + 1);
  if (position.ok() && *position <= most) response.set_queue_position(*position);
  return absl::IsNotFound(position.status()) ? absl::OkStatus() : position.status();
}

/// All of them. Errors: those of GridStore::acquire.
absl::StatusOr<std::vector<GridLease>> acquire(GridStore& grids,
                                               const std::string& space,
                                               const std::vector<std::string>& digests) {
  std::vector<GridLease> held;
  for (const std::string& digest : digests) {
    auto grid = grids.acquire({space, digest});
    if (!grid.ok()) return grid.status();
    held.push_back(*std::move(grid));
  }
  return held;
}

absl::Status create(JobContext& shared,
                    GridStore& grids,
                    Call& call,
                    const v1::CreateJobRequest& request,
                    v1::Job& response) {
  const auto wanted = parse_create(request, call.space());
  if (!wanted.ok()) return wanted.status();
  call.note("grid", wanted->input);
  if (const absl::Status health = shared.health.status(); !health.ok()) {
    return with_retry(health, kAskAgain);
  }
  // Held until the store knows that the job needs them.
  const auto held =
      acquire(grids, call.space(), absl::StrSplit(wanted->input, ' ', absl::SkipEmpty()));
  if (!held.ok()) return held.status();
  const auto created = shared.jobs.create(*wanted);
  if (!created.ok()) return within_field("job", created.status());
  call.note("job", created->job.id);
  return tell(shared, created->job, response, kMostCounted);
}

/// Needs the grids only if there is something to be made.
absl::Status retry(JobContext& shared, GridStore& grids, const Job& job, v1::Job& response) {
  // Held until the store knows that the job needs what is left of it.
  const auto mesh = shared.mesh_of(job);
  if (!mesh.ok()) return mesh.status();
  const auto lost = shared.lost_chunks(job, mesh->get());
  if (!lost.ok()) return lost.status();
  const auto spec = spec_of(job);
  if (!spec.ok()) return spec.status();
  const auto order = order_of(job, *spec);
  if (!order.ok()) return order.status();
  const auto grid = acquire(grids, job.space, files_of(*order));
  const bool is_done = job.state == JobState::kSucceeded && lost->empty();
  if (!grid.ok() && is_finished(job.state) && !is_done) return grid.status();
  return tell(shared, shared.jobs.retry(job.id, *lost), response, kMostCounted);
}

// The list is read first: whoever watches from the revision on misses no change of it.
absl::Status list(JobContext& shared,
                  const std::string& space,
                  const v1::ListJobsRequest& request,
                  v1::ListJobsResponse& response) {
  const auto query = parse_list(request, space);
  if (!query.ok()) return query.status();
  const auto revision = shared.jobs.revision();
  if (!revision.ok()) return revision.status();
  auto page = shared.jobs.list(*query);
  if (!page.ok()) return page.status();
  for (const Job& job : page->jobs) to_proto(job, false, *response.add_jobs());
  response.set_next_page_token(std::move(page->next_page_token));
  response.set_revision(*revision);
  return absl::OkStatus();
}

absl::Status list_dead(JobContext& shared,
                       const std::string& space,
                       const v1::ListDeadShardsRequest& request,
                       v1::ListDeadShardsResponse& response) {
  const auto size = parse_page_size(request.page_size());
  if (!size.ok()) return size.status();
  const auto first = parse_shard_token(request.page_token());
  if (!first.ok()) return first.status();
  const auto job = shared.find(space, request.name());
  if (!job.ok()) return job.status();
  const auto letters = shared.jobs.dead_letters(job->id);
  if (!letters.ok()) return letters.status();
  const std::int64_t count = std::ssize(*letters);
  const std::int64_t end = std::min(*first + *size, count);
  // A thousand take no more than 1.3 MB: an error is at most kMaxStatusBytes.
  for (std::int64_t i = *first; i < end; ++i) {
    to_proto((*letters)[static_cast<std::size_t>(i)], *response.add_shards());
  }
  if (end < count) response.set_next_page_token(absl::StrCat(end));
  return absl::OkStatus();
}

absl::Status list_workers(JobContext& shared,
                          const std::string& space,
                          const v1::ListWorkersRequest& request,
                          v1::ListWorkersResponse& response) {
  const auto size = parse_page_size(request.page_size());
  if (!size.ok()) return size.status();
  const auto after = parse_worker_token(request.page_token());
  if (!after.ok()) return after.status();
  const auto page = shared.jobs.workers({space, *size, *after});
  if (!page.ok()) return page.status();
  // Each may name a hundred shards, of which a thousand workers have more than an answer takes.
  std::size_t bytes = 0;
  auto worker = page->workers.begin();
  for (; worker != page->workers.end() && bytes < kPageBytes; ++worker) {
    v1::Worker& told = *response.add_workers();
    to_proto(*worker, page->read_time, told);
    bytes += told.ByteSizeLong();
  }
  if (!page->is_last || worker != page->workers.end()) {
    response.set_next_page_token(absl::WebSafeBase64Escape(std::prev(worker)->report.name));
  }
  *response.mutable_read_time() = to_proto(page->read_time);
  return absl::OkStatus();
}

/// What the methods that take a job's name have in common: `act` on it if it is the caller's.
template <class Act>
grpc::ServerUnaryReactor* with_job(JobContext& shared,
                                   grpc::CallbackServerContext& context,
                                   const char* method,
                                   const std::string& name,
                                   Act act) {
  return answer(shared.engine.calls, shared.threads, context, method,
                [&shared, name, act = std::move(act)](Call& call) -> absl::Status {
                  const auto job = shared.find(call.space(), name);
                  if (!job.ok()) return job.status();
                  call.note("job", job->id);
                  return act(*job);
                });
}

}  // namespace

grpc::ServerUnaryReactor* JobService::CreateJob(grpc::CallbackServerContext* context,
                                                const v1::CreateJobRequest* request,
                                                v1::Job* response) {
  return answer(shared_.engine.calls, shared_.threads, *context, "CreateJob",
                [this, request, response](Call& call) {
                  return create(shared_, grids_, call, *request, *response);
                });
}

grpc::ServerUnaryReactor* JobService::GetJob(grpc::CallbackServerContext* context,
                                             const v1::GetJobRequest* request,
                                             v1::Job* response) {
  return with_job(shared_, *context, "GetJob", request->name(),
                  [this, response](const Job& job) { return tell(shared_, job, *response); });
}

grpc::ServerUnaryReactor* JobService::ListJobs(grpc::CallbackServerContext* context,
                                               const v1::ListJobsRequest* request,
                                               v1::ListJobsResponse* response) {
  return answer(shared_.engine.calls, shared_.threads, *context, "ListJobs",
                [this, request, response](const Call& call) {
                  return list(shared_, call.space(), *request, *response);
                });
}

grpc::ServerWriteReactor<v1::JobEvent>* JobService::WatchJobs(
    grpc::CallbackServerContext* context, const v1::WatchJobsRequest* request) {
  return JobWatch::start(shared_, *context, *request);
}

grpc::ServerUnaryReactor* JobService::WaitJob(grpc::CallbackServerContext* context,
                                              const v1::WaitJobRequest* request,
                                              v1::Job* response) {
  return JobWait::start(shared_, *context, *request, *response);
}

grpc::ServerUnaryReactor* JobService::CancelJob(grpc::CallbackServerContext* context,
                                                const v1::CancelJobRequest* request,
                                                v1::Job* response) {
  return with_job(shared_, *context, "CancelJob", request->name(),
                  [this, response](const Job& job) {
                    return tell(shared_, shared_.jobs.cancel(job.id), *response);
                  });
}

grpc::ServerUnaryReactor* JobService::RetryJob(grpc::CallbackServerContext* context,
                                               const v1::RetryJobRequest* request,
                                               v1::Job* response) {
  return with_job(
      shared_, *context, "RetryJob", request->name(),
      [this, response](const Job& job) { return retry(shared_, grids_, job, *response); });
}

grpc::ServerUnaryReactor* JobService::DeleteJob(grpc::CallbackServerContext* context,
                                                const v1::DeleteJobRequest* request,
                                                google::protobuf::Empty* /*response*/) {
  return with_job(shared_, *context, "DeleteJob", request->name(),
                  [this](const Job& job) { return shared_.jobs.remove(job.id); });
}

grpc::ServerUnaryReactor* JobService::ListDeadShards(grpc::CallbackServerContext* context,
                                                     const v1::ListDeadShardsRequest* request,
                                                     v1::ListDeadShardsResponse* response) {
  return answer(shared_.engine.calls, shared_.threads, *context, "ListDeadShards",
                [this, request, response](const Call& call) {
                  return list_dead(shared_, call.space(), *request, *response);
                });
}

grpc::ServerUnaryReactor* JobService::ListWorkers(grpc::CallbackServerContext* context,
                                                  const v1::ListWorkersRequest* request,
                                                  v1::ListWorkersResponse* response) {
  return answer(shared_.engine.calls, shared_.threads, *context, "ListWorkers",
                [this, request, response](const Call& call) {
                  return list_workers(shared_, call.space(), *request, *response);
                });
}

grpc::ServerWriteReactor<grpc::ByteBuffer>* JobService::ReadJobResult(
    grpc::CallbackServerContext* context, const grpc::ByteBuffer* request) {
  return ResultStream::start(shared_, *context, *request);
}

}  // namespace tet
