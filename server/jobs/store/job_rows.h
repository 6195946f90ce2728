// A job as a row: read, locked, changed, and written back together with the event that tells of
// it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <absl/time/time.h>

#include "server/jobs/store/job.h"
#include "server/jobs/store/sql_transaction.h"

namespace tet {

/// A time that never comes, in columns.
constexpr std::int64_t kNeverUs = INT64_MAX;

template <class Enum>
constexpr std::int64_t number_of(Enum value) {
  return static_cast<std::int64_t>(value);
}

/// Microseconds since the epoch; kNeverUs for the infinite future. Both bring other times into
/// the years 1 to 9999: what a row says is not to be trusted beyond what everybody can say.
std::int64_t to_us(absl::Time time);
absl::Time from_us(std::int64_t us);
/// A number of a row, which may be damaged or another's, within what we would have written.
std::int64_t bounded(std::int64_t value, std::int64_t least, std::int64_t most);
JobState state_from(std::int64_t number);
Phase phase_from(std::int64_t number);
JobChange change_from(std::int64_t number);
ChunkRange range_from(std::int64_t first, std::int64_t end);
/// `start_us` + `duration`, kNeverUs if that is infinite.
std::int64_t after_us(std::int64_t start_us, absl::Duration duration);

/// A job with the columns that only the store needs.
struct JobRow {
  Job job;
  Phase phase = Phase::kPlan;
  absl::Duration ttl, timeout;
  std::int64_t expire_us = kNeverUs;  ///< when its time to live ends
};

/// What of a job is read beside its small columns.
struct JobColumns {
  bool bytes = false;   ///< spec and header
  bool leases = false;  ///< how many shards are held
};

/// "SELECT columns FROM jobs"; rows are for `job_row`.
std::string select_jobs(JobColumns columns);
JobRow job_row(const SqlRow& row);

/// Keeps the job as it is until the transaction ends. No value: there is none.
std::optional<JobRow> lock_job(SqlTransaction& t, const std::string& id);

/// `input` as in NewJob.
void insert_job(SqlTransaction& t, const JobRow& row, const std::string& input);

/// Writes back what may change, as the job's next version, with an event. The job is locked.
void save_job(SqlTransaction& t, JobRow& row, JobChange change);

}  // namespace tet
