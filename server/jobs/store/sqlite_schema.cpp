#include "server/jobs/store/sqlite_schema.h"

#include <array>

#include <absl/strings/str_cat.h>

#include "proto/convert/status.h"

namespace tet {

namespace {

// Times are microseconds since the epoch, INT64_MAX where they never come. A rank is a priority
// with its sign changed, so that what is first sorts first. docs/jobs.md says what the tables
// are for.
constexpr char kFirstVersion[] = R"sql(
CREATE TABLE counters (name TEXT PRIMARY KEY, value INTEGER NOT NULL) STRICT, WITHOUT ROWID;
INSERT INTO counters VALUES ('token', 0), ('revision', 0), ('compacted', 0);

CREATE TABLE requests (
  space TEXT NOT NULL, request_id TEXT NOT NULL, job_id TEXT NOT NULL, fingerprint TEXT NOT NULL,
  PRIMARY KEY (space, request_id)) STRICT, WITHOUT ROWID;
CREATE INDEX requests_of_job ON requests (job_id);

CREATE TABLE jobs (
  id TEXT NOT NULL PRIMARY KEY, space TEXT NOT NULL, display_name BLOB NOT NULL,
  spec BLOB NOT NULL, header BLOB NOT NULL, labels TEXT NOT NULL, rank INTEGER NOT NULL,
  max_attempts INTEGER NOT NULL, state INTEGER NOT NULL, phase INTEGER NOT NULL,
  version INTEGER NOT NULL, error BLOB NOT NULL, ttl_us INTEGER NOT NULL,
  timeout_us INTEGER NOT NULL, create_us INTEGER NOT NULL, start_us INTEGER NOT NULL,
  plan_us INTEGER NOT NULL, finish_us INTEGER NOT NULL, expire_us INTEGER NOT NULL,
  stop_us INTEGER NOT NULL, chunk_count INTEGER NOT NULL, done_chunks INTEGER NOT NULL,
  shard_count INTEGER NOT NULL, done_shards INTEGER NOT NULL, dead_shards INTEGER NOT NULL,
  alarms INTEGER NOT NULL) STRICT;
CREATE INDEX jobs_by_state ON jobs (state, id);
CREATE INDEX jobs_queued ON jobs (rank, id) WHERE state = 1;
CREATE INDEX jobs_to_stop ON jobs (stop_us) WHERE state <= 2;
CREATE INDEX jobs_finished ON jobs (finish_us) WHERE state >= 3;
CREATE INDEX jobs_with_trouble ON jobs (id) WHERE dead_shards + alarms > 0;

CREATE TABLE queue (
  job_id TEXT NOT NULL, phase INTEGER NOT NULL, number INTEGER NOT NULL,
  first_chunk INTEGER NOT NULL, end_chunk INTEGER NOT NULL, rank INTEGER NOT NULL,
  space TEXT NOT NULL, state INTEGER NOT NULL, token INTEGER NOT NULL, worker TEXT NOT NULL,
  attempt INTEGER NOT NULL, lease_us INTEGER NOT NULL, due_us INTEGER NOT NULL,
  PRIMARY KEY (job_id, phase, number)) STRICT, WITHOUT ROWID;
CREATE INDEX queue_ready ON queue (rank, space, job_id, phase, number) WHERE state = 0;
CREATE INDEX queue_ready_jobs ON queue (job_id) WHERE state = 0;
CREATE INDEX queue_leased ON queue (lease_us) WHERE state = 1;
CREATE INDEX queue_held ON queue (space) WHERE state = 1;
CREATE INDEX queue_held_jobs ON queue (job_id) WHERE state = 1;
CREATE INDEX queue_due ON queue (due_us) WHERE state = 2;

CREATE TABLE shards (
  job_id TEXT NOT NULL, phase INTEGER NOT NULL, number INTEGER NOT NULL,
  first_chunk INTEGER NOT NULL, end_chunk INTEGER NOT NULL, outcome INTEGER NOT NULL,
  token INTEGER NOT NULL, attempts INTEGER NOT NULL, worker TEXT NOT NULL, error BLOB NOT NULL,
  digests BLOB NOT NULL, time_us INTEGER NOT NULL, PRIMARY KEY (job_id, phase, number)) STRICT;

CREATE TABLE events (
  id INTEGER PRIMARY KEY AUTOINCREMENT, revision INTEGER NOT NULL, job_id TEXT NOT NULL, space TEXT NOT NULL,
  version INTEGER NOT NULL, change INTEGER NOT NULL, state INTEGER NOT NULL,
  chunk_count INTEGER NOT NULL, done_chunks INTEGER NOT NULL, shard_count INTEGER NOT NULL, done_shards INTEGER NOT NULL,
  dead_shards INTEGER NOT NULL, time_us INTEGER NOT NULL) STRICT;
CREATE INDEX events_by_revision ON events (revision);
CREATE INDEX events_of_space ON events (space, revision);
CREATE INDEX events_of_job ON events (job_id, revision);
CREATE INDEX events_new ON events (id) WHERE revision = 0;
)sql";

constexpr char kSecondVersion[] = R"sql(
ALTER TABLE jobs ADD COLUMN input TEXT NOT NULL DEFAULT '';
CREATE INDEX jobs_inputs ON jobs (space, input) WHERE state <= 2;
)sql";

constexpr char kThirdVersion[] = R"sql(
ALTER TABLE jobs ADD COLUMN algorithm TEXT NOT NULL DEFAULT '';
ALTER TABLE jobs ADD COLUMN replans INTEGER NOT NULL DEFAULT 0;
ALTER TABLE jobs ADD COLUMN given_back INTEGER NOT NULL DEFAULT 0;
ALTER TABLE jobs ADD COLUMN trouble BLOB NOT NULL DEFAULT x'';
ALTER TABLE queue ADD COLUMN algorithm TEXT NOT NULL DEFAULT '';
CREATE INDEX jobs_of_algorithm ON jobs (algorithm, id) WHERE state <= 2;
CREATE TABLE facts (name TEXT PRIMARY KEY, value TEXT NOT NULL) STRICT, WITHOUT ROWID;
CREATE TABLE workers (
  name TEXT PRIMARY KEY, algorithm TEXT NOT NULL, trouble BLOB NOT NULL,
  seen_us INTEGER NOT NULL) STRICT, WITHOUT ROWID;
)sql";

constexpr char kFourthVersion[] = R"sql(
ALTER TABLE jobs ADD COLUMN room_waits INTEGER NOT NULL DEFAULT 0;
CREATE INDEX jobs_planned ON jobs (phase, id) WHERE state <= 2 AND phase = 2;
)sql";

constexpr char kFifthVersion[] = R"sql(
CREATE INDEX jobs_waiting ON jobs (rank, id) WHERE state <= 2 AND phase = 0 AND room_waits > 0;
)sql";

// A step from each version to the next; steps that were released never change.
constexpr std::array<const char*, 5> kSteps = {kFirstVersion, kSecondVersion, kThirdVersion,
                                               kFourthVersion, kFifthVersion};
constexpr std::int64_t kVersion = kSteps.size();

absl::Status run_steps(SqliteConnection& connection, std::int64_t version) {
  for (; version < kVersion; ++version) {
    auto status = connection.run_script(kSteps[static_cast<std::size_t>(version)]);
    if (!status.ok()) return status;
  }
  return connection.run_script(absl::StrCat("PRAGMA user_version = ", kVersion));
}

/// The version of the schema that is there, which is not too new.
absl::StatusOr<std::int64_t> checked_version(SqliteConnection& connection) {
  const auto found = connection.run("PRAGMA user_version", {});
  if (!found.ok()) return found.status();
  const std::int64_t version = found->rows[0].integer(0);
  if (version <= kVersion) return version;
  return with_reason(
      absl::FailedPreconditionError(absl::StrCat("the job store has schema ", version,
                                                 ", this version knows ", kVersion)),
      "JOB_STORE_TOO_NEW");
}

}  // namespace

absl::Status migrate_sqlite(SqliteConnection& connection) {
  // Reading takes no turn among those that write: a store that is up to date is opened at once.
  auto version = checked_version(connection);
  if (!version.ok() || *version == kVersion) return version.status();
  if (auto begun = connection.begin(); !begun.ok()) return begun.status();
  version = checked_version(connection);  // others may have been first
  const absl::Status status = version.ok() ? run_steps(connection, *version) : version.status();
  if (status.ok()) return connection.commit();
  connection.roll_back();
  return status;
}

}  // namespace tet
