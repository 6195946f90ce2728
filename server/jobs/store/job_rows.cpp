#include "server/jobs/store/job_rows.h"

#include <algorithm>

#include <absl/strings/str_cat.h>

#include "proto/convert/times.h"
#include "server/jobs/store/new_job.h"
#include "server/jobs/store/store_errors.h"

namespace tet {

namespace {

constexpr std::int64_t kMostCounted = std::int64_t{1} << 53;

std::int64_t duration_us(absl::Duration duration) {
  return duration == absl::InfiniteDuration() ? kNeverUs : absl::ToInt64Microseconds(duration);
}

absl::Duration duration_from(std::int64_t us) {
  if (us == kNeverUs) return absl::InfiniteDuration();
  return std::clamp(absl::Microseconds(us), absl::ZeroDuration(), kLongestSpan);
}

void add_event(SqlTransaction& t, const Job& job, JobChange change) {
  t.run(
      "INSERT INTO events (revision, job_id, space, version, change, state, chunk_count, "
      "done_chunks, shard_count, done_shards, dead_shards, time_us) VALUES (0, $1, $2, $3, $4, "
      "$5, $6, $7, $8, $9, $10, $11)",
      {job.id, job.space, job.version, number_of(change), number_of(job.state), job.chunk_count,
       job.done_chunks, job.shard_count, job.done_shards, job.dead_shards, t.now_us()});
}

}  // namespace

std::int64_t to_us(absl::Time time) {
  if (time == absl::InfiniteFuture()) return kNeverUs;
  return absl::ToUnixMicros(std::clamp(time, earliest_time(), latest_time()));
}

absl::Time from_us(std::int64_t us) {
  if (us == kNeverUs) return absl::InfiniteFuture();
  return std::clamp(absl::FromUnixMicros(us), earliest_time(), latest_time());
}

std::int64_t bounded(std::int64_t value, std::int64_t least, std::int64_t most) {
  return std::clamp(value, least, most);
}

JobState state_from(std::int64_t number) {
  return static_cast<JobState>(
      bounded(number, number_of(JobState::kQueued), number_of(JobState::kExpired)));
}

Phase phase_from(std::int64_t number) {
  return static_cast<Phase>(bounded(number, number_of(Phase::kPlan), number_of(Phase::kMesh)));
}

JobChange change_from(std::int64_t number) {
  return static_cast<JobChange>(
      bounded(number, number_of(JobChange::kCreated), number_of(JobChange::kReplanned)));
}

ChunkRange range_from(std::int64_t first, std::int64_t end) {
  const std::int64_t begin = bounded(first, 0, kMostChunks);
  return {begin, bounded(end, begin, kMostChunks)};
}

std::int64_t after_us(std::int64_t start_us, absl::Duration duration) {
  return to_us(from_us(start_us) + duration);
}

std::string select_jobs(JobColumns columns) {
  return absl::StrCat(
      "SELECT id, space, display_name, labels, rank, max_attempts, state, phase, version, "
      "error, "
      "ttl_us, timeout_us, create_us, start_us, plan_us, finish_us, expire_us, stop_us, "
      "chunk_count, done_chunks, shard_count, done_shards, dead_shards, alarms, algorithm, "
      "replans, given_back, trouble, room_waits, ",
      columns.leases
          ? "(SELECT count(*) FROM queue WHERE queue.job_id = jobs.id AND queue.state = 1)"
          : "CAST(0 AS BIGINT)",
      columns.bytes ? ", spec, header" : "", " FROM jobs");
}

JobRow job_row(const SqlRow& row) {
  JobRow read;
  Job& job = read.job;
  std::size_t column = 0;
  const auto integer = [&] { return row.integer(column++); };
  const auto count = [&] { return bounded(integer(), 0, kMostCounted); };
  const auto chunks = [&] { return bounded(integer(), 0, kMostChunks); };
  const auto time = [&] { return from_us(row.integer(column++)); };
  job.id = row.text(column++);
  job.space = row.text(column++);
  job.display_name = row.blob(column++);
  job.labels = decode_labels(row.text(column++));
  job.priority = -bounded(integer(), -kMaxPriority, kMaxPriority);
  job.max_attempts = bounded(integer(), 1, kMaxAttempts);
  job.state = state_from(integer());
  read.phase = phase_from(integer());
  job.version = count();
  job.error = decode_status(row.blob(column++));
  read.ttl = duration_from(integer());
  read.timeout = duration_from(integer());
  job.create_time = time();
  job.start_time = time();
  job.plan_time = time();
  job.finish_time = time();
  read.expire_us = integer();
  job.stop_time = time();
  job.chunk_count = chunks();
  job.done_chunks = chunks();
  job.shard_count = count();
  job.done_shards = count();
  job.dead_shards = count();
  job.alarms = count();
  job.algorithm = row.text(column++);
  job.replans = count();
  job.given_back = count();
  job.trouble = decode_status(row.blob(column++));
  job.waits_for_room = integer() > 0;
  job.leased_shards = count();
  if (column < row.size()) {
    job.spec = row.blob(column++);
    job.header = row.blob(column);
  }
  return read;
}

std::optional<JobRow> lock_job(SqlTransaction& t, const std::string& id) {
  const auto result =
      t.run(absl::StrCat(select_jobs({}), " WHERE id = $1", t.dialect().for_update()), {id});
  if (result.rows.empty()) return std::nullopt;
  return job_row(result.rows[0]);
}

void insert_job(SqlTransaction& t, const JobRow& row, const std::string& input) {
  const Job& job = row.job;
  t.run(
      "INSERT INTO jobs (id, space, display_name, spec, header, labels, rank, max_attempts, "
      "state, phase, version, error, ttl_us, timeout_us, create_us, start_us, plan_us, "
      "finish_us, "
      "expire_us, stop_us, chunk_count, done_chunks, shard_count, done_shards, dead_shards, "
      "alarms, input) VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $5, $12, $13, $14, "
      "$15, "
      "$15, "
      "$15, $16, $16, 0, 0, $17, 0, 0, 0, $18)",
      {job.id, job.space, Blob{job.display_name}, Blob{job.spec}, Blob{},
       encode_labels(job.labels), -job.priority, job.max_attempts, number_of(job.state),
       number_of(row.phase), job.version, duration_us(row.ttl), duration_us(row.timeout),
       to_us(job.create_time), kNeverUs, row.expire_us, job.shard_count, input});
  add_event(t, job, JobChange::kCreated);
}

void save_job(SqlTransaction& t, JobRow& row, JobChange change) {
  Job& job = row.job;
  ++job.version;
  t.run(
      "UPDATE jobs SET state = $2, phase = $3, version = $4, error = $5, start_us = $6, "
      "plan_us = "
      "$7, finish_us = $8, expire_us = $9, stop_us = $10, chunk_count = $11, done_chunks = "
      "$12, "
      "shard_count = $13, done_shards = $14, dead_shards = $15, alarms = $16, algorithm = $17, "
      "replans = $18, room_waits = 0 WHERE id = $1",
      {job.id, number_of(job.state), number_of(row.phase), job.version,
       Blob{encode_status(job.error)}, to_us(job.start_time), to_us(job.plan_time),
       to_us(job.finish_time), row.expire_us, to_us(job.stop_time), job.chunk_count,
       job.done_chunks, job.shard_count, job.done_shards, job.dead_shards, job.alarms,
       job.algorithm, job.replans});
  add_event(t, job, change);
}

}  // namespace tet
