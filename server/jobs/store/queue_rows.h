// Shards as rows: of `queue` while somebody has to do them, of `shards` once they are done or
// dead.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/jobs/store/job_rows.h"

namespace tet {

/// A row of `queue` is in one of these; the numbers are in the partial indices of the schema.
enum class ShardState : std::int64_t { kReady = 0, kLeased = 1, kBackingOff = 2 };

/// What became of a row of `shards`. Numbers are stored.
enum class ShardOutcome : std::int64_t { kDone = 1, kDead = 2 };

/// A leased shard, locked.
struct LeasedRow {
  ShardKey key;
  ChunkRange chunks;
  std::int64_t token = 0, attempt = 0;
  std::string worker;
};

/// Adds shards that are ready: numbers `first_number` on, with these ranges.
void add_to_queue(SqlTransaction& t,
                  const JobRow& row,
                  Phase phase,
                  std::int64_t first_number,
                  std::span<const ChunkRange> ranges);
void add_to_queue(SqlTransaction& t,
                  const JobRow& row,
                  Phase phase,
                  std::int64_t first_number,
                  std::initializer_list<ChunkRange> ranges);

/// The shard if this lease still has it; its job is locked.
std::optional<LeasedRow> lock_leased(SqlTransaction& t, const LeaseId& lease);

/// Moves a leased shard from the queue to those that are done (without error) or dead.
void settle(SqlTransaction& t,
            const LeasedRow& shard,
            ShardOutcome outcome,
            const absl::Status& error,
            const std::string& digests);

/// Makes dead letters of all that is left of a job; says how many. The job is locked.
std::int64_t bury_rest(SqlTransaction& t, const std::string& job, const absl::Status& error);

/// Forgets all shards of a job, whatever became of them. The job is locked.
void drop_shards(SqlTransaction& t, const std::string& job);

/// Makes a job's dead letters ready again.
void revive(SqlTransaction& t, const JobRow& row);

}  // namespace tet
