#include "server/jobs/service/job_messages.h"

#include <algorithm>

#include <absl/strings/escaping.h>
#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_join.h>

#include "core/base/printable.h"
#include "core/base/utf8.h"
#include "proto/convert/request_rules.h"
#include "proto/convert/status.h"
#include "proto/convert/times.h"
#include "server/jobs/store/store_errors.h"

namespace tet {

namespace {

constexpr char kPrefix[] = "jobs/";
constexpr std::size_t kIdDigits = 24;
constexpr std::size_t kMaxQuoted = 60;
constexpr std::size_t kMostWorkerBytes = 128;
constexpr int kDefaultJobs = 100, kMaxJobs = 1000;
constexpr std::int64_t kMostShards = 1'000'000;  ///< more than a job has
constexpr absl::Duration kMaxWait = absl::Hours(1);

bool is_job_id(std::string_view text) {
  const auto is_digit = [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); };
  return text.size() == kIdDigits && std::ranges::all_of(text, is_digit);
}

/// `field` is unset, which is for ever; what else it may be the store says.
absl::StatusOr<absl::Duration> parse_end(bool is_set,
                                         const google::protobuf::Duration& duration,
                                         const std::string& field) {
  return is_set ? parse_span(field, duration) : absl::InfiniteDuration();
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
  const absl::Status fits = check_rules(job.mesh(), {Feature::kJob});
  if (!fits.ok()) return within_field("mesh", fits);
  if (!mesh.ok()) return within_field("mesh", mesh.status());
  const auto ttl = parse_end(job.has_ttl(), job.ttl(), "ttl");
  if (!ttl.ok()) return ttl.status();
  const auto timeout = parse_end(job.has_timeout(), job.timeout(), "timeout");
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
  const absl::Time end = std::min(job.finish_time, job.read_time);
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
  *progress.mutable_eta() = to_proto(absl::Seconds(left / rate));
}

void set_asked(const Job& job, v1::Job& message) {
  stored::JobSpec spec;
  if (!spec.ParseFromString(job.spec)) return;
  *message.mutable_mesh() = std::move(*spec.mutable_mesh());
  if (spec.has_ttl()) *message.mutable_ttl() = within_range(spec.ttl());
  if (spec.has_timeout()) *message.mutable_timeout() = within_range(spec.timeout());
  message.set_skip_cache(spec.skip_cache());
}

void set_plan(const Job& job, bool with_header, v1::Job& message) {
  stored::JobPlan plan;
  if (job.header.empty() || !plan.ParseFromString(job.header) || !plan.has_header()) return;
  message.set_cached(plan.cached());
  if (with_header) *message.mutable_header() = std::move(*plan.mutable_header());
}

void set_times(const Job& job, v1::Job& message) {
  *message.mutable_create_time() = to_proto(job.create_time);
  const absl::Time never = absl::InfiniteFuture();
  if (job.start_time != never) *message.mutable_start_time() = to_proto(job.start_time);
  if (job.finish_time != never) *message.mutable_finish_time() = to_proto(job.finish_time);
  if (job.stop_time != never) *message.mutable_stop_time() = to_proto(job.stop_time);
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
  if (filter.has_created_from()) {
    const auto from = parse_time("created_from", filter.created_from());
    if (!from.ok()) return within_field("filter", from.status());
    query.filter.created_from = *from;
  }
  if (filter.has_created_before()) {
    const auto before = parse_time("created_before", filter.created_before());
    if (!before.ok()) return within_field("filter", before.status());
    query.filter.created_before = *before;
  }
  query.page_size = *page_size;
  query.page_token = request.page_token();
  return query;
}

absl::StatusOr<absl::Duration> parse_wait(const v1::WaitJobRequest& request) {
  if (!request.has_timeout()) return kMaxWait;
  const auto timeout = parse_span("timeout", request.timeout());
  if (!timeout.ok() || (*timeout >= absl::ZeroDuration() && *timeout <= kMaxWait)) {
    return timeout;
  }
  return invalid_field(absl::StrCat("timeout ", absl::FormatDuration(*timeout),
                                    " is not from 0 to an hour: wait again after an hour"));
}

absl::StatusOr<std::int64_t> parse_page_size(std::int32_t page_size) {
  if (page_size < 0)
    return invalid_field(absl::StrCat("page_size ", page_size, " is negative"));
  return page_size == 0 ? kDefaultJobs : std::min(page_size, kMaxJobs);
}

absl::StatusOr<std::int64_t> parse_shard_token(const std::string& token) {
  std::int64_t shards = 0;
  if (token.empty()) return shards;
  if (absl::SimpleAtoi(token, &shards) && shards >= 0 && shards <= kMostShards) return shards;
  return invalid_field(
      absl::StrCat("page_token \"", printable(token, kMaxQuoted),
                   "\" was not given by this server: begin at the first page"));
}

absl::StatusOr<std::string> parse_worker_token(const std::string& token) {
  std::string name;
  const bool known = absl::WebSafeBase64Unescape(token, &name) &&
                     name.size() <= kMostWorkerBytes && is_utf8(name) &&
                     name.find('\0') == std::string::npos;
  if (known) return name;
  return invalid_field(
      absl::StrCat("page_token \"", printable(token, kMaxQuoted),
                   "\" was not given by this server: begin at the first page"));
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
  message.set_replans(static_cast<int>(std::min<std::int64_t>(job.replans, INT32_MAX)));
  message.set_given_back_shards(job.given_back);
  if (job.trouble.ok()) return;
  message.mutable_last_give_back()->ParseFromString(encode_status(job.trouble));
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
  *message.mutable_time() = to_proto(event.time);
}

void to_proto(const DeadLetter& letter, v1::DeadShard& message) {
  message.set_first_chunk(letter.chunks.first);
  message.set_end_chunk(letter.chunks.end);
  message.set_attempts(static_cast<int>(letter.attempts));
  message.set_worker(letter.worker);
  message.mutable_error()->ParseFromString(encode_status(letter.error));
  *message.mutable_time() = to_proto(letter.time);
}

void to_proto(const KnownWorker& worker, absl::Time read_time, v1::Worker& message) {
  message.set_name(worker.report.name);
  message.set_algorithm_version(worker.report.algorithm);
  *message.mutable_seen_time() = to_proto(worker.seen);
  message.set_lost(read_time - worker.seen > kWorkerAlive);
  if (!worker.report.trouble.ok()) {
    message.mutable_trouble()->ParseFromString(encode_status(worker.report.trouble));
  }
  message.set_leased_shards(worker.leased_shards);
  for (const HeldShard& held : worker.shards) {
    v1::LeasedShard& shard = *message.add_shards();
    shard.set_job(name_of_job(held.shard.job));
    shard.set_first_chunk(held.chunks.first);
    shard.set_end_chunk(held.chunks.end);
    shard.set_attempt(static_cast<int>(held.attempt));
    *shard.mutable_lease_end_time() = to_proto(held.expires);
  }
}

}  // namespace tet
