#include "tetstream/jobs.h"

#include <algorithm>
#include <utility>

#include "client/library/api/client_impl.h"
#include "client/library/api/job_messages.h"
#include "client/library/api/mesh_impl.h"
#include "client/library/api/stream_impl.h"
#include "client/library/api/to_public.h"
#include "client/library/api/work.h"
#include "client/library/served_range.h"
#include "proto/wire/serialized.h"
#include "tetstream/v1/jobs.grpc.pb.h"

namespace tetstream {
namespace {

/// How many jobs are listed at once.
constexpr std::uint64_t kJobsAPage = 1000;

Result<Job> public_job(const absl::StatusOr<v1::Job>& job) {
  if (!job.ok()) return to_public(job.status());
  return to_public(*job);
}

/// One call about one job.
using JobCall = absl::StatusOr<v1::Job> (tet::JobClient::*)(const std::string&,
                                                            const tet::Cancellation&);
Result<Job> ask(const Client::Impl& client,
                JobCall call,
                const std::string& name,
                const WorkOptions& options) {
  return guarded([&]() -> Result<Job> {
    const Work work(options);
    return public_job((client.jobs.get()->*call)(name, work.cancellation()));
  });
}

template <class Solid>
Result<Job> submit_job(const Client::Impl& client,
                       const Solid& solid,
                       const Request& request,
                       const JobOrder& order,
                       const WorkOptions& options) {
  return guarded([&]() -> Result<Job> {
    const Work work(options);
    auto mesh = message_of(*client.meshes, solid, request, work.cancellation());
    if (!mesh.ok()) return to_public(mesh.status());
    v1::Job job = message_of(order);
    *job.mutable_mesh() = *std::move(mesh);
    return public_job(client.jobs->create(job, request_id_of(order), work.cancellation()));
  });
}

/// Looks at a job until it is at its end, woken by its changes.
class Waiting {
 public:
  Waiting(tet::JobClient& jobs, const std::string& name, const WorkOptions& options)
      : jobs_(jobs), name_(name), options_(options), work_(options) {}

  Result<Job> run() {
    for (;;) {
      const auto known = jobs_.get(name_, work_.cancellation());
      if (!known.ok()) return to_public(known.status());
      Job job = to_public(*known);
      tell(job.progress);
      if (is_final(job.state)) return job;
      if (const absl::Status status = watch(known->version()); !status.ok()) {
        return to_public(status);
      }
    }
  }

 private:
  /// Until it may be at its end. What came before `version` is known.
  absl::Status watch(std::int64_t version) {
    const auto see = [&](const v1::JobEvent& event) {
      const JobEvent change = to_public(event);
      if (event.version() < version) return true;
      tell(change.progress);
      return !is_final(change.state) && change.change != JobChange::kDeleted;
    };
    return jobs_.watch(name_, 0, see, work_.cancellation());
  }

  void tell(const JobProgress& progress) const {
    if (options_.progress) options_.progress(progress.fraction());
  }

  tet::JobClient& jobs_;
  const std::string& name_;
  const WorkOptions& options_;
  const Work work_;
};

tet::RangeCall result_call(const std::string& name, ChunkRange chunks) {
  const auto request = [name](std::uint64_t first, std::uint64_t end, const std::string&) {
    v1::ReadJobResultRequest message;
    message.set_name(name);
    message.set_start_chunk(static_cast<std::int64_t>(first));
    message.set_end_chunk(static_cast<std::int64_t>(end));
    return tet::serialized(message);
  };
  return {v1::JobService::service_full_name(), "ReadJobResult", request, chunks.first,
          chunks.end};
}

tet::ClientProgress tets_of(const WorkOptions& options) {
  if (!options.progress) return {};
  return {.upload = {},
          .planning = {},
          .tets = [tell = options.progress](std::uint64_t done, std::uint64_t total) {
            if (total > 0) tell(static_cast<double>(done) / static_cast<double>(total));
          }};
}

}  // namespace

Jobs::Jobs(const Client& client) : client_(client.impl()) {}

Result<Job> Jobs::submit(const StoredVolume& volume,
                         const Request& request,
                         const JobOrder& order,
                         const WorkOptions& options) const {
  return submit_job(*client_, volume, request, order, options);
}

Result<Job> Jobs::submit(const Scene& scene,
                         const Request& request,
                         const JobOrder& order,
                         const WorkOptions& options) const {
  return submit_job(*client_, scene, request, order, options);
}

Result<Job> Jobs::get(const std::string& name, const WorkOptions& options) const {
  return ask(*client_, &tet::JobClient::get, name, options);
}

Result<Job> Jobs::cancel(const std::string& name, const WorkOptions& options) const {
  return ask(*client_, &tet::JobClient::cancel, name, options);
}

Result<Job> Jobs::retry(const std::string& name, const WorkOptions& options) const {
  return ask(*client_, &tet::JobClient::retry, name, options);
}

Status Jobs::remove(const std::string& name, const WorkOptions& options) const {
  return guarded([&]() -> Status {
    const Work work(options);
    return to_public(client_->jobs->remove(name, work.cancellation()));
  });
}

Result<JobList> Jobs::list(const JobFilter& filter, const WorkOptions& options) const {
  return guarded([&]() -> Result<JobList> {
    const Work work(options);
    const std::uint64_t most = filter.most == 0 ? UINT64_MAX : filter.most;
    v1::ListJobsRequest request;
    *request.mutable_filter() = message_of(filter);
    JobList all;
    do {
      request.set_page_size(
          static_cast<std::int32_t>(std::min(kJobsAPage, most - all.jobs.size())));
      const auto page = client_->jobs->list(request, work.cancellation());
      if (!page.ok()) return to_public(page.status());
      if (request.page_token().empty()) all.revision = page->revision();
      for (const v1::Job& job : page->jobs()) all.jobs.push_back(to_public(job));
      request.set_page_token(page->next_page_token());
    } while (!request.page_token().empty() && all.jobs.size() < most);
    return all;
  });
}

Result<Job> Jobs::wait(const std::string& name, const WorkOptions& options) const {
  return guarded([&] { return Waiting(*client_->jobs, name, options).run(); });
}

Status Jobs::watch(const std::string& name,
                   std::int64_t after_revision,
                   const std::function<bool(const JobEvent&)>& see,
                   const WorkOptions& options) const {
  return guarded([&]() -> Status {
    const Work work(options);
    return to_public(client_->jobs->watch(
        name, after_revision, [&](const v1::JobEvent& event) { return see(to_public(event)); },
        work.cancellation()));
  });
}

Result<Mesh> Jobs::fetch(const std::string& name, const WorkOptions& options) const {
  return guarded([&]() -> Result<Mesh> {
    const Work work(options);
    auto mesh = client_->jobs->read_result(name, tets_of(options), work.cancellation());
    if (!mesh.ok()) return to_public(mesh.status());
    tet::TrailerFacts facts{std::nullopt, mesh->boundary, mesh->improvement, mesh->thin_walls};
    if (!mesh->quality.empty()) facts.quality = mesh->quality;
    return public_mesh(std::move(mesh->mesh), facts, mesh->mesh_id);
  });
}

MeshStream Jobs::stream(const std::string& name,
                        const WorkOptions& options,
                        ChunkRange chunks) const {
  auto stream = std::make_unique<MeshStream::Impl>(options);
  stream->begin =
      [client = client_, name, options, chunks](
          const tet::Cancellation& cancellation) -> Result<std::unique_ptr<tet::ChunkSupply>> {
    return std::unique_ptr<tet::ChunkSupply>(std::make_unique<tet::ServedRange>(
        client->connection, result_call(name, chunks), tets_of(options), cancellation));
  };
  return MeshStream(std::move(stream));
}

}  // namespace tetstream
