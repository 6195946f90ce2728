#include "client/library/api/job_messages.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <random>

#include <absl/strings/str_format.h>
#include <absl/time/time.h>

#include "client/library/api/to_public.h"
#include "client/library/error_details.h"
#include "client/library/stream_checks.h"
#include "proto/convert/times.h"

namespace tetstream {
namespace {

template <class Count>
std::uint64_t count_of(Count count) {
  return static_cast<std::uint64_t>(std::max<Count>(count, 0));
}

Job::Time time_of(bool is_set, const google::protobuf::Timestamp& time) {
  if (!is_set) return std::nullopt;
  const auto within = tet::within_range(time);
  return absl::ToChronoTime(absl::FromUnixSeconds(within.seconds()) +
                            absl::Nanoseconds(within.nanos()));
}

absl::Duration span_of(const google::protobuf::Duration& span) {
  const auto within = tet::within_range(span);
  return absl::Seconds(within.seconds()) + absl::Nanoseconds(within.nanos());
}

std::optional<std::chrono::milliseconds> milliseconds_of(
    bool is_set, const google::protobuf::Duration& span) {
  if (!is_set) return std::nullopt;
  return absl::ToChronoMilliseconds(span_of(span));
}

JobProgress progress_of(const v1::JobProgress& progress) {
  JobProgress result{.chunk_count = count_of(progress.chunk_count()),
                     .done_chunks = count_of(progress.done_chunks()),
                     .shard_count = count_of(progress.shard_count()),
                     .done_shards = count_of(progress.done_shards()),
                     .running_shards = count_of(progress.running_shards()),
                     .dead_shards = count_of(progress.dead_shards()),
                     .chunks_per_second = progress.chunks_per_second()};
  if (progress.has_eta()) result.eta_seconds = absl::ToDoubleSeconds(span_of(progress.eta()));
  return result;
}

/// What a later server may say and we do not know is as near as can be.
JobState state_of(v1::JobState state) {
  return static_cast<JobState>(
      std::clamp<int>(state, v1::JOB_STATE_QUEUED, v1::JOB_STATE_EXPIRED));
}

JobChange change_of(v1::JobChange change) {
  return static_cast<JobChange>(
      std::clamp<int>(change, v1::JOB_CHANGE_CREATED, v1::JOB_CHANGE_REPLANNED));
}

JobOrder order_of(const v1::Job& job) {
  JobOrder order{.display_name = job.display_name(),
                 .labels = {job.labels().begin(), job.labels().end()},
                 .priority = job.priority(),
                 .ttl = milliseconds_of(job.has_ttl(), job.ttl()),
                 .timeout = milliseconds_of(job.has_timeout(), job.timeout()),
                 .max_attempts = {},
                 .skip_cache = job.skip_cache()};
  if (job.has_max_attempts()) order.max_attempts = job.max_attempts();
  return order;
}

}  // namespace

v1::Job message_of(const JobOrder& order) {
  v1::Job job;
  job.set_display_name(order.display_name);
  for (const auto& [key, value] : order.labels) (*job.mutable_labels())[key] = value;
  job.set_priority(order.priority);
  if (order.ttl) *job.mutable_ttl() = tet::to_proto(absl::FromChrono(*order.ttl));
  if (order.timeout) *job.mutable_timeout() = tet::to_proto(absl::FromChrono(*order.timeout));
  if (order.max_attempts) job.set_max_attempts(*order.max_attempts);
  job.set_skip_cache(order.skip_cache);
  return job;
}

v1::JobFilter message_of(const JobFilter& filter) {
  v1::JobFilter message;
  for (const JobState state : filter.states) {
    message.add_states(static_cast<v1::JobState>(state));
  }
  for (const auto& [key, value] : filter.labels) (*message.mutable_labels())[key] = value;
  message.set_display_name_prefix(filter.display_name_prefix);
  return message;
}

Job to_public(const v1::Job& job) {
  Job result{.name = job.name(),
             .order = order_of(job),
             .state = state_of(job.state()),
             .version = count_of(job.version()),
             .created = time_of(job.has_create_time(), job.create_time()),
             .started = time_of(job.has_start_time(), job.start_time()),
             .finished = time_of(job.has_finish_time(), job.finish_time()),
             .queue_position = {},
             .progress = progress_of(job.progress()),
             .error = {},
             .cached = job.cached(),
             .header = {}};
  if (job.has_queue_position()) result.queue_position = count_of(job.queue_position());
  if (job.has_error()) result.error = to_public(tet::to_absl(job.error()));
  if (!job.has_header()) return result;
  if (const auto header = tet::checked_header(job.header()); header.ok()) {
    result.header = to_public(*header, job.header().mesh_id());
  }
  return result;
}

JobEvent to_public(const v1::JobEvent& event) {
  return {.revision = event.revision(),
          .name = event.name(),
          .version = count_of(event.version()),
          .change = change_of(event.change()),
          .state = state_of(event.state()),
          .progress = progress_of(event.progress()),
          .time = time_of(event.has_time(), event.time())};
}

std::string request_id_of(const JobOrder& order) {
  if (!order.request_id.empty()) return order.request_id;
  std::random_device random;
  return absl::StrFormat("%08x%08x%08x%08x", random(), random(), random(), random());
}

}  // namespace tetstream
