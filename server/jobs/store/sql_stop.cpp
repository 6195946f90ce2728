// The store for whoever stops jobs: clients, the clock, and the broom. And for whoever counts
// them.
#include <absl/strings/str_cat.h>
#include <absl/strings/str_split.h>

#include "proto/convert/status.h"
#include "server/jobs/store/new_job.h"
#include "server/jobs/store/queue_rows.h"
#include "server/jobs/store/sql_job_store.h"
#include "server/jobs/store/store_errors.h"

namespace tet {

namespace {

// Jobs ended by one look at the clock.
constexpr std::int64_t kExpiredAtOnce = 500;

/// What is left of the job becomes dead letters, so that it can be tried again.
void stop(SqlTransaction& t, JobRow& row, JobState state, const absl::Status& why) {
  row.job.dead_shards += bury_rest(t, row.job.id, why);
  row.job.state = state;
  row.job.error = why;
  row.job.finish_time = from_us(t.now_us());
  save_job(t, row, JobChange::kFinished);
}

absl::Status expired_error(const JobRow& row) {
  return with_reason(absl::DeadlineExceededError(absl::StrCat(
                         "job ", row.job.id, " was not finished within its ttl of ",
                         absl::FormatDuration(row.ttl))),
                     "JOB_EXPIRED");
}

absl::Status timeout_error(const JobRow& row) {
  return with_reason(absl::DeadlineExceededError(absl::StrCat(
                         "job ", row.job.id, " ran for longer than its timeout of ",
                         absl::FormatDuration(row.timeout))),
                     "JOB_TIMEOUT");
}

/// Whether the job's time was up.
bool expire_job(SqlTransaction& t, const std::string& id) {
  auto row = lock_job(t, id);
  if (!row || is_finished(row->job.state)) return false;
  if (to_us(row->job.stop_time) > t.now_us()) return false;
  if (row->expire_us <= t.now_us()) {
    stop(t, *row, JobState::kExpired, expired_error(*row));
  } else {
    stop(t, *row, JobState::kFailed, timeout_error(*row));
  }
  return true;
}

/// Makes dead letters of shards that are done, but of which such a chunk was lost.
void bury_lost(SqlTransaction& t, JobRow& row, std::span<const std::int64_t> chunks) {
  for (const std::int64_t chunk : chunks) {
    const auto buried = t.run(
        "UPDATE shards SET outcome = 2 WHERE job_id = $1 AND phase = $2 AND outcome = 1 AND "
        "first_chunk <= $3 AND end_chunk > $3 RETURNING first_chunk, end_chunk",
        {row.job.id, number_of(Phase::kMesh), chunk});
    for (const SqlRow& shard : buried.rows) {
      --row.job.done_shards;
      ++row.job.dead_shards;
      row.job.done_chunks -= range_from(shard.integer(0), shard.integer(1)).size();
    }
  }
}

/// Why a job cannot be tried again; OK if it can.
absl::Status check_retry(const Job& job) {
  if (job.state == JobState::kSucceeded && job.dead_shards == 0) {
    return with_reason(
        absl::FailedPreconditionError(absl::StrCat("job ", job.id, " has succeeded")),
        "JOB_SUCCEEDED");
  }
  if (is_finished(job.state)) return absl::OkStatus();
  return with_reason(
      absl::FailedPreconditionError(absl::StrCat("job ", job.id, " is ", name_of(job.state))),
      "JOB_ACTIVE");
}

void renew(JobRow& row, std::int64_t now_us) {
  row.job.state = JobState::kQueued;
  row.job.error = absl::OkStatus();
  row.job.dead_shards = 0;
  row.job.start_time = row.job.finish_time = absl::InfiniteFuture();
  row.expire_us = after_us(now_us, row.ttl);
  row.job.stop_time = from_us(row.expire_us);
}

void count_shards(SqlTransaction& t, StoreCounts& counts) {
  counts.ready_shards = t.integer("SELECT count(*) FROM queue WHERE state = 0");
  counts.leased_shards = t.integer("SELECT count(*) FROM queue WHERE state = 1");
  counts.backing_off = t.integer("SELECT count(*) FROM queue WHERE state = 2");
  const auto sums = t.run(
      "SELECT CAST(COALESCE(sum(dead_shards), 0) AS BIGINT), CAST(COALESCE(sum(alarms), 0) AS "
      "BIGINT) FROM jobs WHERE dead_shards + alarms > 0");
  if (sums.rows.empty()) return;
  counts.dead_shards = sums.rows[0].integer(0);
  counts.alarms = sums.rows[0].integer(1);
}

void count_workers(SqlTransaction& t, StoreCounts& counts) {
  const auto alive = t.run("SELECT trouble FROM workers WHERE seen_us >= $1",
                           {after_us(t.now_us(), -kWorkerAlive)});
  for (const SqlRow& row : alive.rows) {
    ++counts.workers;
    counts.troubled_workers += row.blob(0).empty() ? 0 : 1;
  }
}

}  // namespace

absl::StatusOr<Job> SqlJobStore::cancel(const std::string& id) {
  const absl::Status status = transact(
      *database_,
      [&](SqlTransaction& t) {
        auto row = lock_job(t, id);
        if (!row) return job_not_found(id);
        if (is_finished(row->job.state)) return absl::OkStatus();
        stop(t, *row, JobState::kCancelled,
             with_reason(absl::CancelledError(absl::StrCat("job ", id, " was cancelled")),
                         "JOB_CANCELLED"));
        return absl::OkStatus();
      },
      Purpose::kRoom);
  if (!status.ok()) return status;
  return get(id);
}

absl::StatusOr<Job> SqlJobStore::retry(const std::string& id,
                                       std::span<const std::int64_t> lost_chunks) {
  const absl::Status status = transact(*database_, [&](SqlTransaction& t) {
    auto row = lock_job(t, id);
    if (!row) return job_not_found(id);
    if (is_finished(row->job.state)) bury_lost(t, *row, lost_chunks);
    if (auto wrong = check_retry(row->job); !wrong.ok()) return wrong;
    if (auto full = check_room(t, row->job.space); !full.ok()) return full;
    revive(t, *row);
    renew(*row, t.now_us());
    save_job(t, *row, JobChange::kRetried);
    return absl::OkStatus();
  });
  if (!status.ok()) return status;
  return get(id);
}

absl::StatusOr<std::int64_t> SqlJobStore::expire() {
  std::vector<std::string> due;
  auto status = transact(*database_, [&](SqlTransaction& t) {
    due.clear();
    const auto found = t.run(
        "SELECT id FROM jobs WHERE state <= 2 AND stop_us <= $1 ORDER BY stop_us LIMIT $2",
        {t.now_us(), kExpiredAtOnce});
    for (const SqlRow& row : found.rows) due.push_back(row.text(0));
    return absl::OkStatus();
  });
  std::int64_t expired = 0;
  for (auto id = due.begin(); status.ok() && id != due.end(); ++id) {
    bool mine = false;
    status = transact(
        *database_,
        [&](SqlTransaction& t) {
          mine = expire_job(t, *id);
          return absl::OkStatus();
        },
        Purpose::kRoom);
    expired += status.ok() && mine ? 1 : 0;
  }
  if (!status.ok()) return status;
  return expired;
}

absl::StatusOr<std::int64_t> SqlJobStore::purge(absl::Duration finished_for) {
  // Watchers are told of what they miss by its revision.
  if (auto status = number_all_events(); !status.ok()) return status;
  std::int64_t now_us = 0;
  const absl::Status status = transact(*database_, [&](SqlTransaction& t) {
    now_us = t.now_us();
    t.run("DELETE FROM workers WHERE seen_us < $1", {after_us(now_us, -kWorkerForgotten)});
    return absl::OkStatus();
  });
  if (!status.ok()) return status;
  return database_->purge(after_us(now_us, -finished_for));
}

absl::StatusOr<StoreCounts> SqlJobStore::counts() {
  StoreCounts counts;
  const absl::Status status = transact(*database_, [&](SqlTransaction& t) {
    counts = {};
    for (const SqlRow& row : t.run("SELECT state, count(*) FROM jobs GROUP BY state").rows) {
      counts.jobs[state_from(row.integer(0))] += row.integer(1);
    }
    count_shards(t, counts);
    count_workers(t, counts);
    const auto oldest = t.run(
        "SELECT create_us FROM jobs WHERE id = (SELECT min(job_id) FROM queue WHERE state = "
        "0)");
    if (!oldest.rows.empty()) {
      counts.oldest_ready_age = from_us(t.now_us()) - from_us(oldest.rows[0].integer(0));
    }
    return absl::OkStatus();
  });
  if (!status.ok()) return status;
  return counts;
}

absl::StatusOr<absl::Time> SqlJobStore::ask_time() {
  absl::Time now;
  const absl::Status status = transact(*database_, [&](SqlTransaction& t) {
    now = from_us(t.now_us());
    return absl::OkStatus();
  });
  if (!status.ok()) return status;
  return now;
}

absl::Status SqlJobStore::probe() {
  const absl::Status written = transact(*database_, [](SqlTransaction& t) {
    t.run(
        "INSERT INTO counters (name, value) VALUES ('probe', $1) ON CONFLICT (name) DO UPDATE "
        "SET value = $1",
        {t.now_us()});
    return absl::OkStatus();
  });
  if (written.ok()) database_->keep_room();
  return written;
}

absl::StatusOr<std::vector<PlannedJob>> SqlJobStore::planned() {
  std::vector<PlannedJob> jobs;
  const absl::Status status = read(*database_, [&](SqlTransaction& t) {
    jobs.clear();
    for (const SqlRow& row : t.run(kPlannedJobs).rows) {
      jobs.push_back(
          {row.text(0), row.text(1), row.blob(2), row.integer(3) > 0, row.integer(4)});
    }
    return absl::OkStatus();
  });
  if (!status.ok()) return status;
  return jobs;
}

absl::StatusOr<std::vector<PatientJob>> SqlJobStore::patient() {
  std::vector<PatientJob> jobs;
  const absl::Status status = read(*database_, [&](SqlTransaction& t) {
    jobs.clear();
    for (const SqlRow& row : t.run(kPatientJobs, {kPatientLooks, kMostPatient}).rows) {
      jobs.push_back({row.text(0), row.text(1), row.blob(2),
                      -bounded(row.integer(3), -kMaxPriority, kMaxPriority)});
    }
    return absl::OkStatus();
  });
  if (!status.ok()) return status;
  return jobs;
}

absl::StatusOr<std::set<JobInput>> SqlJobStore::inputs() {
  std::set<JobInput> inputs;
  const absl::Status status = read(*database_, [&](SqlTransaction& t) {
    inputs.clear();
    const auto found =
        t.run("SELECT DISTINCT space, input FROM jobs WHERE state <= 2 AND input <> ''");
    for (const SqlRow& row : found.rows) {
      for (const absl::string_view name : absl::StrSplit(row.text(1), ' ')) {
        inputs.insert({row.text(0), std::string(name)});
      }
    }
    return absl::OkStatus();
  });
  if (!status.ok()) return status;
  return inputs;
}

}  // namespace tet
