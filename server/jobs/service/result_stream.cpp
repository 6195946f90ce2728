#include "server/jobs/service/result_stream.h"

#include <algorithm>
#include <utility>

#include <absl/strings/str_cat.h>

#include "proto/convert/status.h"
#include "proto/wire/serialized.h"
#include "server/jobs/service/job_messages.h"
#include "server/ops/guard.h"

namespace tet {

namespace {

/// Digests read at once, and how many chunks behind they are forgotten.
constexpr std::int64_t kDigestsPerPage = 1024;

absl::Status parse(grpc::ByteBuffer request, v1::ReadJobResultRequest& message) {
  if (!deserialize(request, message)) {
    return with_reason(absl::InvalidArgumentError("the request is not a ReadJobResultRequest"),
                       "MALFORMED");
  }
  const auto negative = [](const char* field, std::int64_t value) {
    return value >= 0 ? absl::OkStatus()
                      : invalid_field(absl::StrCat(field, " ", value, " is negative"));
  };
  const absl::Status start = negative("start_chunk", message.start_chunk());
  return start.ok() ? negative("end_chunk", message.end_chunk()) : start;
}

absl::Status not_succeeded(const Job& job) {
  return with_reason(absl::FailedPreconditionError(absl::StrCat(
                         "job ", job.id, " is ", name_of(job.state), ", not SUCCEEDED",
                         job.error.ok() ? "" : ": ", job.error.message())),
                     "JOB_NOT_SUCCEEDED");
}

}  // namespace

grpc::ServerWriteReactor<grpc::ByteBuffer>* ResultStream::start(
    JobContext& shared, grpc::CallbackServerContext& context, const grpc::ByteBuffer& request) {
  const std::shared_ptr<ResultStream> stream(new ResultStream(shared, context));
  const absl::Status parsed =
      guarded("ReadJobResult", [&] { return parse(request, stream->request_); });
  return ChunkStream::start(stream, parsed);
}

void ResultStream::admitted() { call_.note("job", request_.name()); }

void ResultStream::open() {
  shared_.threads.post(call_.client(), [self = self()] {
    self->begin_chunks(guarded("ReadJobResult", [&] { return self->find_result(); }),
                       static_cast<std::uint64_t>(self->request_.start_chunk()),
                       static_cast<std::uint64_t>(self->request_.end_chunk()));
  });
}

absl::Status ResultStream::find_result() {
  const auto job = shared_.find(call_.space(), request_.name());
  if (!job.ok()) return job.status();
  if (job->state != JobState::kSucceeded) return not_succeeded(*job);
  auto plan = plan_of(*job);
  if (!plan.ok()) return plan.status();
  id_ = job->id;
  plan_ = *std::move(plan);
  auto folder = shared_.results.make({job->space, plan_.header().mesh_id()});
  if (!folder.ok()) return folder.status();
  folder_ = *std::move(folder);
  return absl::OkStatus();
}

std::uint64_t ResultStream::chunk_count() const {
  return static_cast<std::uint64_t>(
      std::clamp<std::int64_t>(plan_.header().chunk_count(), 0, kMostChunks));
}

v1::MeshEvent ResultStream::header() const {
  v1::MeshEvent event;
  *event.mutable_header() = plan_.header();
  return event;
}

absl::StatusOr<ChunkMessage> ResultStream::make(std::uint64_t index, Block block) {
  const auto digest = digest_of_chunk(static_cast<std::int64_t>(index));
  if (!digest.ok()) return digest.status();
  return folder_->get_chunk(*digest, engine_.blocks, std::move(block.lease));
}

absl::StatusOr<ChunkDigest> ResultStream::digest_of_chunk(std::int64_t index) {
  const std::lock_guard lock(digests_mutex_);
  if (!digests_.contains(index)) {
    const std::int64_t end =
        std::min(index + kDigestsPerPage, static_cast<std::int64_t>(chunk_count()));
    auto page = shared_.jobs.chunk_digests(id_, {index, end});
    if (!page.ok()) return page.status();
    digests_.erase(digests_.begin(), digests_.lower_bound(index - kDigestsPerPage));
    digests_.merge(*page);
  }
  const auto found = digests_.find(index);
  if (found != digests_.end()) return found->second;
  return with_reason(
      absl::FailedPreconditionError(absl::StrCat("job ", id_, " is being made again")),
      "JOB_NOT_SUCCEEDED");
}

v1::MeshEvent ResultStream::trailer(std::uint64_t first,
                                    std::uint64_t end,
                                    const QualityStats& quality) const {
  return trailer_event(plan_, first, end, quality);
}

}  // namespace tet
