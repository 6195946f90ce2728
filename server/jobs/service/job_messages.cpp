#include "server/jobs/service/job_messages.h"

#include <algorithm>

#include <absl/strings/escaping.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_join.h>
#include <absl/time/clock.h>
#include <google/protobuf/util/time_util.h>

#include "proto/convert/call_identity.h"
#include "proto/convert/status.h"
#include "server/jobs/store/store_errors.h"

namespace tet {

namespace {

using google::protobuf::util::TimeUtil;

constexpr char kPrefix[] = "jobs/";
constexpr std::size_t kIdDigits = 24;
constexpr std::size_t kMaxQuoted = 60;
constexpr int kDefaultJobs = 100, kMaxJobs = 1000;
constexpr absl::Duration kMaxWait = absl::Hours(1);

bool is_job_id(std::string_view text) {
  const auto is_digit = [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); };
  return text.size() == kIdDigits && std::ranges::all_of(text, is_digit);
}

// Protobuf's own limits are checked where a message is read, not before.
bool is_valid(const google::protobuf::Duration& duration) {
  return duration.seconds() >= TimeUtil::kDurationMinSeconds &&
         duration.seconds() <= TimeUtil::kDurationMaxSeconds &&
         std::abs(duration.nanos()) < 1'000'000'000;
}

absl::Duration duration_of(const google::protobuf::Duration& duration) {
  return absl::Seconds(duration.seconds()) + absl::Nanoseconds(duration.nanos());
}

void set(absl::Duration duration, google::protobuf::Duration& message) {
  message.set_seconds(absl::IDivDuration(duration, absl::Seconds(1), &duration));
  message.set_nanos(static_cast<int>(absl::ToInt64Nanoseconds(duration)));
}

void set(absl::Time time, google::protobuf::Timestamp& message) {
  message = TimeUtil::MicrosecondsToTimestamp(absl::ToUnixMicros(time));
}

absl::Time time_of(const google::protobuf::Timestamp& time) {
  return absl::FromUnixSeconds(time.seconds()) + absl::Nanoseconds(time.nanos());
}

/// `field` is unset, or more than nothing.
absl::StatusOr<absl::Duration> parse_span(bool is_set,
                                          const google::protobuf::Duration& duration,
                                          const std::string& field) {
  if (!is_set) return absl::InfiniteDuration();
  if (!is_valid(duration)) return invalid_field(absl::StrCat(field, " is no duration"));
  const absl::Duration span = duration_of(duration);
  if (span > absl::ZeroDuration()) return span;
  return invalid_field(
      absl::StrCat(field, " ", absl::FormatDuration(span), " is not positive"));
}

/// Fields that say how a job stands are not the client's to set.
absl::Status check_unset(const v1::Job& job) {
  std::vector<const google::protobuf::FieldDescriptor*> fields;
  job.GetReflection()->ListFields(job, &fields);
  for (const auto* field : fields) {
    if (field->number() == v1::Job::kNameFieldNumber ||
        field->number() >= v1::Job::kStateFieldNumber) {
      return invalid_field(absl::StrCat(field->name(), " is set by the server"));
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<NewJob> parse_job(const v1::Job& job) {
  if (auto status = check_unset(job); !status.ok()) return status;
  const auto mesh = parse_mesh_request(job.mesh());
  if (!mesh.ok()) return within_field("mesh", mesh.status());
  const auto ttl = parse_span(job.has_ttl(), job.ttl(), "ttl");
  if (!ttl.ok()) return ttl.status();
  const auto timeout = parse_span(job.has_timeout(), job.timeout(), "timeout");
  if (!timeout.ok()) return timeout.status();
  stored::JobSpec spec;
  *spec.mutable_mesh() = job.mesh();
  spec.mutable_mesh()->clear_skip_statistics();  // whoever reads the result may want them
  if (job.has_ttl()) *spec.mutable_ttl() = job.ttl();
  if (job.has_timeout()) *spec.mutable_timeout() = job.timeout();
  spec.set_skip_cache(job.skip_cache());
  NewJob wanted;
  wanted.display_name = job.display_name();
  wanted.spec = spec.SerializeAsString();
  wanted.input = absl::StrJoin(files_of(*mesh), " ");
  wanted.labels = {job.labels().begin(), job.labels().end()};
  wanted.priority = job.priority();
  wanted.ttl = *ttl;
  wanted.timeout = *timeout;
  if (job.has_max_attempts()) wanted.max_attempts = job.max_attempts();
  return wanted;
}

double rate_of(const Job& job) {
  if (job.done_chunks == 0 || job.plan_time == absl::InfiniteFuture()) return 0;
  const absl::Time end = std::min(job.finish_time, absl::Now());
  const double seconds = absl::ToDoubleSeconds(end - job.plan_time);
  return seconds > 0 ? static_cast<double>(job.done_chunks) / seconds : 0;
}

void set_progress(const Job& job, v1::JobProgress& progress) {
  progress.set_chunk_count(job.chunk_count);
  progress.set_done_chunks(job.done_chunks);
  progress.set_shard_count(job.shard_count);
  progress.set_done_shards(job.done_shards);
  progress.set_running_shards(job.leased_shards);
  progress.set_dead_shards(job.dead_shards);
  const double rate = rate_of(job);
  progress.set_chunks_per_second(rate);
  if (rate == 0 || is_finished(job.state)) return;
  const auto left = static_cast<double>(job.chunk_count - job.done_chunks);
  set(absl::Seconds(left / rate), *progress.mutable_eta());
}

void set_asked(const Job& job, v1::Job& message) {
  stored::JobSpec spec;
  if (!spec.ParseFromString(job.spec)) return;
  *message.mutable_mesh() = std::move(*spec.mutable_mesh());
  if (spec.has_ttl()) *message.mutable_ttl() = spec.ttl();
  if (spec.has_timeout()) *message.mutable_timeout() = spec.timeout();
  message.set_skip_cache(spec.skip_cache());
}

void set_plan(const Job& job, bool with_header, v1::Job& message) {
  stored::JobPlan plan;
  if (job.header.empty() || !plan.ParseFromString(job.header) || !plan.has_header()) return;
  message.set_cached(plan.cached());
  if (with_header) *message.mutable_header() = std::move(*plan.mutable_header());
}

void set_times(const Job& job, v1::Job& message) {
  set(job.create_time, *message.mutable_create_time());
  const absl::Time never = absl::InfiniteFuture();
  if (job.start_time != never) set(job.start_time, *message.mutable_start_time());
  if (job.finish_time != never) set(job.finish_time, *message.mutable_finish_time());
  if (job.stop_time != never) set(job.stop_time, *message.mutable_stop_time());
}

}  // namespace

absl::StatusOr<std::string> parse_job_name(const std::string& name) {
  const std::string_view text = name;
  if (text.starts_with(kPrefix) && is_job_id(text.substr(std::size(kPrefix) - 1))) {
    return name.substr(std::size(kPrefix) - 1);
  }
  return invalid_field(absl::StrCat("name \"", printable(name, kMaxQuoted),
                                    "\" is not jobs/ and 24 lower-case hexadecimal digits"));
}

absl::StatusOr<NewJob> parse_create(const v1::CreateJobRequest& request,
                                    const std::string& space) {
  auto job = parse_job(request.job());
  if (!job.ok()) return within_field("job", job.status());
  job->space = space;
  job->request_id = request.request_id();
  return job;
}

absl::StatusOr<ListJobs> parse_list(const v1::ListJobsRequest& request,
                                    const std::string& space) {
  const auto page_size = parse_page_size(request.page_size());
  if (!page_size.ok()) return page_size.status();
  const v1::JobFilter& filter = request.filter();
  ListJobs query;
  query.filter.space = space;
  for (const int state : filter.states()) {
    if (state < v1::JOB_STATE_QUEUED || state > v1::JOB_STATE_EXPIRED) {
      return within_field(
          "filter", invalid_field(absl::StrCat("states has ", state, ", which is no state")));
    }
    query.filter.states.insert(static_cast<JobState>(state));
  }
  query.filter.labels = {filter.labels().begin(), filter.labels().end()};
  query.filter.name_prefix = filter.display_name_prefix();
  if (filter.has_created_from()) query.filter.created_from = time_of(filter.created_from());
  if (filter.has_created_before()) {
    query.filter.created_before = time_of(filter.created_before());
  }
  query.page_size = *page_size;
  query.page_token = request.page_token();
  return query;
}

absl::StatusOr<absl::Duration> parse_wait(const v1::WaitJobRequest& request) {
  if (!request.has_timeout()) return kMaxWait;
  const absl::Duration timeout =
      is_valid(request.timeout()) ? duration_of(request.timeout()) : absl::InfiniteDuration();
  if (timeout >= absl::ZeroDuration() && timeout <= kMaxWait) return timeout;
  return invalid_field(
      absl::StrCat("timeout ", absl::FormatDuration(timeout), " is not from 0 to an hour"));
}

absl::StatusOr<std::int64_t> parse_page_size(std::int32_t page_size) {
  if (page_size < 0)
    return invalid_field(absl::StrCat("page_size ", page_size, " is negative"));
  return page_size == 0 ? kDefaultJobs : std::min(page_size, kMaxJobs);
}

std::string name_of_job(const std::string& id) { return kPrefix + id; }

void to_proto(const Job& job, bool with_header, v1::Job& message) {
  message.set_name(name_of_job(job.id));
  set_asked(job, message);
  message.set_display_name(job.display_name);
  message.mutable_labels()->insert(job.labels.begin(), job.labels.end());
  message.set_priority(static_cast<int>(job.priority));
  message.set_max_attempts(static_cast<int>(job.max_attempts));
  message.set_state(static_cast<v1::JobState>(job.state));
  message.set_version(job.version);
  set_times(job, message);
  set_progress(job, *message.mutable_progress());
  if (!job.error.ok()) message.mutable_error()->ParseFromString(encode_status(job.error));
  set_plan(job, with_header, message);
  message.set_determinism_alarms(job.alarms);
}

void to_proto(const JobEvent& event, v1::JobEvent& message) {
  message.set_revision(event.revision);
  message.set_name(name_of_job(event.job));
  message.set_version(event.version);
  message.set_change(static_cast<v1::JobChange>(event.change));
  message.set_state(static_cast<v1::JobState>(event.state));
  v1::JobProgress& progress = *message.mutable_progress();
  progress.set_chunk_count(event.chunk_count);
  progress.set_done_chunks(event.done_chunks);
  progress.set_shard_count(event.shard_count);
  progress.set_done_shards(event.done_shards);
  progress.set_dead_shards(event.dead_shards);
  set(event.time, *message.mutable_time());
}

void to_proto(const DeadLetter& letter, v1::DeadShard& message) {
  message.set_first_chunk(letter.chunks.first);
  message.set_end_chunk(letter.chunks.end);
  message.set_attempts(static_cast<int>(letter.attempts));
  message.set_worker(letter.worker);
  message.mutable_error()->ParseFromString(encode_status(letter.error));
  set(letter.time, *message.mutable_time());
}

}  // namespace tet
