#include "server/jobs/store/postgres_schema.h"

#include <array>
#include <string>
#include <vector>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <absl/strings/str_replace.h>
#include <absl/strings/str_split.h>

#include "proto/convert/status.h"
#include "server/jobs/store/store_errors.h"

namespace tet {

namespace {

// The tables are those of the embedded engine, but jobs, shards and events are divided by the
// job's id, which begins with the time of its creation, so that forgetting old jobs is dropping
// tables. Text sorts by its bytes. `queue` churns: it is vacuumed long before a fifth of it is
// dead.
constexpr char kFirstVersion[] = R"sql(
CREATE SEQUENCE tokens;
CREATE SEQUENCE event_ids;
CREATE TABLE counters (name TEXT COLLATE "C" PRIMARY KEY, value BIGINT NOT NULL);
INSERT INTO counters VALUES ('revision', 0), ('compacted', 0);

CREATE TABLE requests (
  space TEXT COLLATE "C" NOT NULL, request_id TEXT COLLATE "C" NOT NULL,
  job_id TEXT COLLATE "C" NOT NULL, fingerprint TEXT NOT NULL, PRIMARY KEY (space, request_id));
CREATE INDEX requests_of_job ON requests (job_id);

CREATE TABLE jobs (
  id TEXT COLLATE "C" NOT NULL PRIMARY KEY, space TEXT COLLATE "C" NOT NULL,
  display_name BYTEA NOT NULL, spec BYTEA NOT NULL, header BYTEA NOT NULL, labels TEXT NOT NULL,
  rank BIGINT NOT NULL, max_attempts BIGINT NOT NULL, state BIGINT NOT NULL, phase BIGINT NOT NULL,
  version BIGINT NOT NULL, error BYTEA NOT NULL, ttl_us BIGINT NOT NULL,
  timeout_us BIGINT NOT NULL, create_us BIGINT NOT NULL, start_us BIGINT NOT NULL,
  plan_us BIGINT NOT NULL, finish_us BIGINT NOT NULL, expire_us BIGINT NOT NULL,
  stop_us BIGINT NOT NULL, chunk_count BIGINT NOT NULL, done_chunks BIGINT NOT NULL,
  shard_count BIGINT NOT NULL, done_shards BIGINT NOT NULL, dead_shards BIGINT NOT NULL,
  alarms BIGINT NOT NULL) PARTITION BY RANGE (id);
CREATE INDEX jobs_by_state ON jobs (state, id);
CREATE INDEX jobs_queued ON jobs (rank, id) WHERE state = 1;
CREATE INDEX jobs_to_stop ON jobs (stop_us) WHERE state <= 2;
CREATE INDEX jobs_finished ON jobs (finish_us) WHERE state >= 3;
CREATE INDEX jobs_with_trouble ON jobs (id) WHERE dead_shards + alarms > 0;
CREATE TABLE jobs_default PARTITION OF jobs DEFAULT;

CREATE TABLE queue (
  job_id TEXT COLLATE "C" NOT NULL, phase BIGINT NOT NULL, number BIGINT NOT NULL,
  first_chunk BIGINT NOT NULL, end_chunk BIGINT NOT NULL, rank BIGINT NOT NULL,
  space TEXT COLLATE "C" NOT NULL, state BIGINT NOT NULL, token BIGINT NOT NULL,
  worker TEXT NOT NULL, attempt BIGINT NOT NULL, lease_us BIGINT NOT NULL, due_us BIGINT NOT NULL,
  PRIMARY KEY (job_id, phase, number))
  WITH (autovacuum_vacuum_scale_factor = 0.02, autovacuum_analyze_scale_factor = 0.05);
CREATE INDEX queue_ready ON queue (rank, space, job_id, phase, number) WHERE state = 0;
CREATE INDEX queue_ready_jobs ON queue (job_id) WHERE state = 0;
CREATE INDEX queue_leased ON queue (lease_us) WHERE state = 1;
CREATE INDEX queue_held ON queue (space) WHERE state = 1;
CREATE INDEX queue_held_jobs ON queue (job_id) WHERE state = 1;
CREATE INDEX queue_due ON queue (due_us) WHERE state = 2;

CREATE TABLE shards (
  job_id TEXT COLLATE "C" NOT NULL, phase BIGINT NOT NULL, number BIGINT NOT NULL,
  first_chunk BIGINT NOT NULL, end_chunk BIGINT NOT NULL, outcome BIGINT NOT NULL,
  token BIGINT NOT NULL, attempts BIGINT NOT NULL, worker TEXT NOT NULL, error BYTEA NOT NULL,
  digests BYTEA NOT NULL, time_us BIGINT NOT NULL, PRIMARY KEY (job_id, phase, number))
  PARTITION BY RANGE (job_id);
CREATE TABLE shards_default PARTITION OF shards DEFAULT;

CREATE TABLE events (
  id BIGINT NOT NULL DEFAULT nextval('event_ids'), revision BIGINT NOT NULL,
  job_id TEXT COLLATE "C" NOT NULL, space TEXT COLLATE "C" NOT NULL, version BIGINT NOT NULL, change BIGINT NOT NULL,
  state BIGINT NOT NULL, chunk_count BIGINT NOT NULL, done_chunks BIGINT NOT NULL, shard_count BIGINT NOT NULL,
  done_shards BIGINT NOT NULL, dead_shards BIGINT NOT NULL, time_us BIGINT NOT NULL)
  PARTITION BY RANGE (job_id);
CREATE INDEX events_by_revision ON events (revision);
CREATE INDEX events_of_space ON events (space, revision);
CREATE INDEX events_of_job ON events (job_id, revision);
CREATE INDEX events_new ON events (id) WHERE revision = 0;
CREATE TABLE events_default PARTITION OF events DEFAULT;
)sql";

constexpr char kSecondVersion[] = R"sql(
ALTER TABLE jobs ADD COLUMN input TEXT COLLATE "C" NOT NULL DEFAULT '';
CREATE INDEX jobs_inputs ON jobs (space, input) WHERE state <= 2;
)sql";

constexpr char kThirdVersion[] = R"sql(
ALTER TABLE jobs ADD COLUMN algorithm TEXT COLLATE "C" NOT NULL DEFAULT '';
ALTER TABLE jobs ADD COLUMN replans BIGINT NOT NULL DEFAULT 0;
ALTER TABLE jobs ADD COLUMN given_back BIGINT NOT NULL DEFAULT 0;
ALTER TABLE jobs ADD COLUMN trouble BYTEA NOT NULL DEFAULT '';
ALTER TABLE queue ADD COLUMN algorithm TEXT COLLATE "C" NOT NULL DEFAULT '';
CREATE INDEX jobs_of_algorithm ON jobs (algorithm, id) WHERE state <= 2;
CREATE TABLE facts (name TEXT COLLATE "C" PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE workers (
  name TEXT COLLATE "C" PRIMARY KEY, algorithm TEXT COLLATE "C" NOT NULL, trouble BYTEA NOT NULL,
  seen_us BIGINT NOT NULL);
)sql";

constexpr char kFourthVersion[] = R"sql(
ALTER TABLE jobs ADD COLUMN room_waits BIGINT NOT NULL DEFAULT 0;
CREATE INDEX jobs_planned ON jobs (phase, id) WHERE state <= 2 AND phase = 2;
)sql";

constexpr char kFifthVersion[] = R"sql(
CREATE INDEX jobs_waiting ON jobs (rank, id) WHERE state <= 2 AND phase = 0 AND room_waits > 0;
)sql";

// A step from each version to the next; steps that were released never change.
constexpr std::array<const char*, 5> kSteps = {kFirstVersion, kSecondVersion, kThirdVersion,
                                               kFourthVersion, kFifthVersion};
constexpr std::int64_t kVersion = kSteps.size();

// Whoever opens the store holds this advisory lock while it looks at the schema.
// Whoever starts first makes the tables, for longer than others wait for a lock in their work.
constexpr char kBeginMigration[] =
    "BEGIN; SET LOCAL lock_timeout = '2min'; SELECT pg_advisory_xact_lock(7447101); "
    "SET LOCAL client_min_messages = error; "
    "CREATE TABLE IF NOT EXISTS schema_version (version BIGINT NOT NULL); "
    "SELECT COALESCE(max(version), 0)::text FROM schema_version";

constexpr std::int64_t kPartitionsAhead = 3;

absl::Status check_version(std::int64_t version) {
  if (version <= kVersion) return absl::OkStatus();
  return with_reason(
      absl::FailedPreconditionError(absl::StrCat("the job store has schema ", version,
                                                 ", this version knows ", kVersion)),
      "JOB_STORE_TOO_NEW");
}

absl::Status run_steps(PostgresConnection& connection, std::int64_t version) {
  for (; version < kVersion; ++version) {
    const auto step = connection.run_script(kSteps[static_cast<std::size_t>(version)]);
    if (!step.ok()) return step.status();
  }
  return connection
      .run_script(absl::StrCat(
          "DELETE FROM schema_version; INSERT INTO schema_version VALUES (", kVersion, ")"))
      .status();
}

/// Ids from `first` up to `end` are of jobs made within one span. Its tables are named after
/// both.
struct Partition {
  std::string first, end;
  std::string name() const { return absl::StrCat(first, "_", end); }
};

std::string id_at(std::int64_t us) { return absl::StrFormat("%014x", us); }

/// Another server may have made it, or dropped it.
absl::StatusOr<bool> is_there(PostgresConnection& connection, const Partition& partition) {
  const auto found = connection.run("SELECT to_regclass($1) IS NOT NULL",
                                    {{absl::StrCat("jobs_", partition.name())}});
  if (!found.ok()) return found.status();
  return found->rows[0].integer(0) != 0;
}

absl::Status make_partition(PostgresConnection& connection, const Partition& partition) {
  const auto there = is_there(connection, partition);
  if (!there.ok()) return there.status();
  if (*there) return absl::OkStatus();
  std::string sql;
  for (const char* parent : {"jobs", "shards", "events"}) {
    absl::StrAppend(&sql, "CREATE TABLE ", parent, "_", partition.name(), " PARTITION OF ",
                    parent, " FOR VALUES FROM ('", partition.first, "') TO ('", partition.end,
                    "');");
  }
  const absl::Status made = connection.run_script(sql).status();
  // Another server made it, or another span did, or rows lie in the default partition already,
  // or the tables are too busy just now: the default partition takes what comes.
  return connection.usable() ? absl::OkStatus() : made;
}

absl::StatusOr<std::vector<Partition>> list_partitions(PostgresConnection& connection) {
  const auto found = connection.run(
      "SELECT relname::text FROM pg_inherits JOIN pg_class ON pg_class.oid = inhrelid WHERE "
      "inhparent = 'jobs'::regclass AND relname <> 'jobs_default' ORDER BY 1",
      {});
  if (!found.ok()) return found.status();
  std::vector<Partition> partitions;
  for (const SqlRow& row : found->rows) {
    const std::vector<std::string> parts = absl::StrSplit(row.text(0), '_');
    if (parts.size() == 3) partitions.push_back({parts[1], parts[2]});
  }
  return partitions;
}

/// Whoever uses a table that is divided locks it before its partitions. Dropping a partition
/// locks both, too, and would wait in a circle with a reader of the table if it had the
/// partition first. So it takes the tables first, in the order in which everybody uses them.
constexpr char kLockTables[] = "LOCK TABLE ONLY jobs, ONLY shards, ONLY events IN ";

/// The jobs of a partition; -1 while one of them, or an event, is not old enough.
absl::StatusOr<std::int64_t> count_old(PostgresConnection& connection,
                                       const Partition& partition,
                                       std::int64_t before_us) {
  constexpr char kCount[] = R"sql(
SELECT CASE
  WHEN EXISTS (SELECT 1 FROM jobs_$p WHERE state <= 2 OR finish_us >= $before) OR
       EXISTS (SELECT 1 FROM events_$p WHERE revision = 0 OR time_us >= $before) THEN '-1'
  ELSE (SELECT count(*)::text FROM jobs_$p) END
)sql";
  const auto found = connection.run_script(absl::StrReplaceAll(
      kCount, {{"$p", partition.name()}, {"$before", absl::StrCat(before_us)}}));
  if (!found.ok()) return found.status();
  return std::strtoll(found->rows[0].text(0).c_str(), nullptr, 10);
}

/// `count_old`, and nobody else can change the jobs until the transaction ends; -1, too, where
/// the partition is gone.
absl::StatusOr<std::int64_t> lock_old(PostgresConnection& connection,
                                      const Partition& partition,
                                      std::int64_t before_us) {
  const auto locked = connection.run_script(
      absl::StrCat("SET LOCAL lock_timeout = '2s'; ", kLockTables, "ACCESS EXCLUSIVE MODE"));
  if (!locked.ok()) return locked.status();
  const auto there = is_there(connection, partition);
  if (!there.ok()) return there.status();
  if (!*there) return -1;
  return count_old(connection, partition, before_us);
}

absl::Status drop(PostgresConnection& connection, const Partition& partition) {
  constexpr char kDrop[] = R"sql(
UPDATE counters SET value = GREATEST(value, (SELECT COALESCE(max(revision), 0) FROM events_$p))
  WHERE name = 'compacted';
DELETE FROM requests WHERE job_id >= '$first' AND job_id < '$end';
DROP TABLE jobs_$p, shards_$p, events_$p;
)sql";
  return connection
      .run_script(absl::StrReplaceAll(
          kDrop,
          {{"$p", partition.name()}, {"$first", partition.first}, {"$end", partition.end}}))
      .status();
}

absl::StatusOr<std::int64_t> drop_if_old(PostgresConnection& connection,
                                         const Partition& partition,
                                         std::int64_t before_us) {
  // Nobody waits while it is looked at what is not old, as most is.
  const auto looked = count_old(connection, partition, before_us);
  if (!looked.ok()) {
    const auto there = is_there(connection, partition);
    if (there.ok() && !*there) return 0;
    return looked.status();
  }
  if (*looked < 0) return 0;
  if (auto begun = connection.begin(); !begun.ok()) return begun.status();
  auto jobs = lock_old(connection, partition, before_us);
  absl::Status status = jobs.status();
  if (status.ok() && *jobs >= 0) status = drop(connection, partition);
  if (!status.ok() || *jobs < 0) {
    connection.roll_back();
    if (!status.ok()) return status;
    return 0;
  }
  if (status = connection.commit(); !status.ok()) return status;
  return *jobs;
}

/// Jobs that were made while their span had no partition.
absl::StatusOr<std::int64_t> purge_default(PostgresConnection& connection,
                                           std::int64_t before_us) {
  constexpr char kPurge[] = R"sql(
BEGIN;
$lock ACCESS SHARE MODE;
CREATE TEMPORARY TABLE old_jobs ON COMMIT DROP AS
  SELECT id FROM jobs_default WHERE state >= 3 AND finish_us < $before FOR UPDATE;
CREATE TEMPORARY TABLE old_events ON COMMIT DROP AS
  SELECT id, revision FROM events_default WHERE revision > 0 AND time_us < $before AND
    (job_id IN (SELECT id FROM old_jobs) OR
     NOT EXISTS (SELECT 1 FROM jobs WHERE jobs.id = events_default.job_id));
UPDATE counters SET value = GREATEST(value, (SELECT COALESCE(max(revision), 0) FROM old_events))
  WHERE name = 'compacted';
DELETE FROM events_default WHERE id IN (SELECT id FROM old_events);
DELETE FROM shards_default WHERE job_id IN (SELECT id FROM old_jobs);
DELETE FROM requests WHERE job_id IN (SELECT id FROM old_jobs);
DELETE FROM jobs_default WHERE id IN (SELECT id FROM old_jobs);
)sql";
  const auto purged = connection.run_script(absl::StrReplaceAll(
      kPurge, {{"$before", absl::StrCat(before_us)}, {"$lock", kLockTables}}));
  if (!purged.ok()) {
    connection.roll_back();
    return purged.status();
  }
  if (auto status = connection.commit(); !status.ok()) return status;
  return purged->changed;
}

}  // namespace

absl::Status migrate_postgres(PostgresConnection& connection) {
  const auto found = connection.run_script(kBeginMigration);
  absl::Status status = found.status();
  if (status.ok()) {
    const std::int64_t version = std::strtoll(found->rows[0].text(0).c_str(), nullptr, 10);
    status = check_version(version);
    if (status.ok() && version < kVersion) status = run_steps(connection, version);
  }
  if (status.ok()) return connection.commit();
  connection.roll_back();
  return status;
}

absl::Status make_partitions(PostgresConnection& connection, absl::Duration span) {
  const auto now_us = connection.begin();
  if (!now_us.ok()) return now_us.status();
  connection.roll_back();
  const std::int64_t span_us = absl::ToInt64Microseconds(span);
  std::int64_t first_us = *now_us / span_us * span_us;
  for (std::int64_t i = 0; i < kPartitionsAhead; ++i, first_us += span_us) {
    auto made = make_partition(connection, {id_at(first_us), id_at(first_us + span_us)});
    if (!made.ok()) return made;
  }
  return absl::OkStatus();
}

absl::StatusOr<std::int64_t> drop_partitions(PostgresConnection& connection,
                                             std::int64_t finished_before_us) {
  const auto partitions = list_partitions(connection);
  if (!partitions.ok()) return partitions.status();
  auto total = purge_default(connection, finished_before_us);
  for (const Partition& partition : *partitions) {
    if (!total.ok() || partition.end > id_at(finished_before_us)) break;
    const auto dropped = drop_if_old(connection, partition, finished_before_us);
    if (!dropped.ok()) return dropped.status();
    *total += *dropped;
  }
  return total;
}

}  // namespace tet
