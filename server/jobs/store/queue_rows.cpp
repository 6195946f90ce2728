#include "server/jobs/store/queue_rows.h"

#include <algorithm>

#include <absl/strings/str_cat.h>

#include "server/jobs/store/new_job.h"
#include "server/jobs/store/store_errors.h"

namespace tet {

namespace {

// One statement for so many shards: the round trips no longer count, and the text stays short.
constexpr std::size_t kRowsAtOnce = 256;

/// "WITH new (n, a, b) AS (VALUES ($6, $7, $8), ...) INSERT ...", for `count` shards.
std::string insert_shards(std::size_t count) {
  std::string values;
  for (std::size_t i = 0; i < count; ++i) {
    absl::StrAppend(&values, i == 0 ? "" : ", ", "($", 3 * i + 6, ", $", 3 * i + 7, ", $",
                    3 * i + 8, ")");
  }
  return absl::StrCat("WITH new (n, a, b) AS (VALUES ", values,
                      ") INSERT INTO queue (job_id, phase, number, first_chunk, end_chunk, "
                      "rank, space, state, "
                      "token, worker, attempt, lease_us, due_us, algorithm) SELECT $1, $2, n, "
                      "a, b, $3, $4, 0, 0, '', 0, 0, 0, $5 FROM new");
}

/// Rows are locked in the order of their keys, as everybody locks them. This waits for whoever
/// is claiming one of them.
void lock_queue(SqlTransaction& t, const std::string& job) {
  t.run(
      absl::StrCat("SELECT count(*) FROM (SELECT number FROM queue WHERE job_id = $1 ORDER BY "
                   "phase, number",
                   t.dialect().for_update(), ") AS locked"),
      {job});
}

}  // namespace

void add_to_queue(SqlTransaction& t,
                  const JobRow& row,
                  Phase phase,
                  std::int64_t first_number,
                  std::span<const ChunkRange> ranges) {
  for (std::size_t begin = 0; begin < ranges.size(); begin += kRowsAtOnce) {
    const auto some = ranges.subspan(begin, std::min(kRowsAtOnce, ranges.size() - begin));
    std::vector<SqlValue> values = {row.job.id, number_of(phase), -row.job.priority,
                                    row.job.space, row.job.algorithm};
    for (const ChunkRange& range : some) {
      values.emplace_back(first_number++);
      values.emplace_back(range.first);
      values.emplace_back(range.end);
    }
    t.run(insert_shards(some.size()), values);
  }
}

void add_to_queue(SqlTransaction& t,
                  const JobRow& row,
                  Phase phase,
                  std::int64_t first_number,
                  std::initializer_list<ChunkRange> ranges) {
  add_to_queue(t, row, phase, first_number, std::span(ranges.begin(), ranges.size()));
}

std::optional<LeasedRow> lock_leased(SqlTransaction& t, const LeaseId& lease) {
  const auto found =
      t.run(absl::StrCat(
                "SELECT first_chunk, end_chunk, attempt, worker FROM queue WHERE job_id = $1 "
                "AND phase = $2 AND number = $3 AND token = $4 AND state = 1",
                t.dialect().for_update()),
            {lease.shard.job, number_of(lease.shard.phase), lease.shard.number, lease.token});
  if (found.rows.empty()) return std::nullopt;
  const SqlRow& row = found.rows[0];
  return LeasedRow{lease.shard, range_from(row.integer(0), row.integer(1)), lease.token,
                   bounded(row.integer(2), 0, kMaxAttempts), row.text(3)};
}

void settle(SqlTransaction& t,
            const LeasedRow& shard,
            ShardOutcome outcome,
            const absl::Status& error,
            const std::string& digests) {
  t.run("DELETE FROM queue WHERE job_id = $1 AND phase = $2 AND number = $3",
        {shard.key.job, number_of(shard.key.phase), shard.key.number});
  t.run(
      "INSERT INTO shards (job_id, phase, number, first_chunk, end_chunk, outcome, token, "
      "attempts, "
      "worker, error, digests, time_us) VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, "
      "$12)",
      {shard.key.job, number_of(shard.key.phase), shard.key.number, shard.chunks.first,
       shard.chunks.end, number_of(outcome), shard.token, shard.attempt, shard.worker,
       Blob{encode_status(error)}, Blob{digests}, t.now_us()});
}

std::int64_t bury_rest(SqlTransaction& t, const std::string& job, const absl::Status& error) {
  lock_queue(t, job);
  t.run(
      "INSERT INTO shards (job_id, phase, number, first_chunk, end_chunk, outcome, token, "
      "attempts, "
      "worker, error, digests, time_us) SELECT job_id, phase, number, first_chunk, end_chunk, "
      "2, "
      "token, attempt, worker, $2, $3, $4 FROM queue WHERE job_id = $1",
      {job, Blob{encode_status(error)}, Blob{}, t.now_us()});
  return t.run("DELETE FROM queue WHERE job_id = $1", {job}).changed;
}

void drop_shards(SqlTransaction& t, const std::string& job) {
  lock_queue(t, job);
  t.run("DELETE FROM queue WHERE job_id = $1", {job});
  t.run("DELETE FROM shards WHERE job_id = $1", {job});
}

void revive(SqlTransaction& t, const JobRow& row) {
  t.run(
      "INSERT INTO queue (job_id, phase, number, first_chunk, end_chunk, rank, space, state, "
      "token, worker, attempt, lease_us, due_us, algorithm) SELECT job_id, phase, number, "
      "first_chunk, end_chunk, $2, $3, 0, 0, '', 0, 0, 0, $4 FROM shards WHERE job_id = $1 "
      "AND outcome = 2",
      {row.job.id, -row.job.priority, row.job.space, row.job.algorithm});
  t.run("DELETE FROM shards WHERE job_id = $1 AND outcome = 2", {row.job.id});
}

}  // namespace tet
