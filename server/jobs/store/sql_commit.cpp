// The store for workers who have a shard: its end, whatever that is.
#include <algorithm>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_join.h>

#include "proto/convert/status.h"
#include "server/jobs/store/new_job.h"
#include "server/jobs/store/queue_rows.h"
#include "server/jobs/store/sql_job_store.h"
#include "server/jobs/store/store_errors.h"

namespace tet {

namespace {

constexpr std::size_t kDigestBytes = 32;
// Shards taken back by one look at the queue.
constexpr std::int64_t kRescuedAtOnce = 500;

std::string text_of(const ShardKey& shard) {
  constexpr const char* kNames[] = {"plan", "count", "mesh"};
  return absl::StrCat(kNames[number_of(shard.phase)], " shard ", shard.number, " of job ",
                      shard.job);
}

void finish(SqlTransaction& t, JobRow& row, JobState state) {
  row.job.state = state;
  row.job.finish_time = from_us(t.now_us());
  save_job(t, row, JobChange::kFinished);
}

/// When all shards of a phase are done or dead: on to what comes next.
void end_phase(SqlTransaction& t, JobRow& row) {
  if (row.job.done_shards + row.job.dead_shards < row.job.shard_count) return;
  if (row.job.dead_shards > 0) return finish(t, row, JobState::kFailed);
  if (row.phase == Phase::kMesh) return finish(t, row, JobState::kSucceeded);
  row.phase = Phase::kPlan;
  row.job.shard_count = 1;
  row.job.done_shards = 0;
  add_to_queue(t, row, Phase::kPlan, 1, {{0, 0}});
}

void begin_phase(SqlTransaction& t, JobRow& row, const Plan& plan) {
  row.phase = plan.phase;
  row.job.algorithm = plan.algorithm;
  row.job.shard_count = std::ssize(plan.shards);
  row.job.done_shards = 0;
  t.run("UPDATE jobs SET header = $2 WHERE id = $1", {row.job.id, Blob{plan.header}});
  add_to_queue(t, row, plan.phase, 0, plan.shards);
  if (plan.phase == Phase::kMesh) {
    row.job.chunk_count = plan.shards.empty() ? 0 : plan.shards.back().end;
    row.job.plan_time = from_us(t.now_us());
  }
  save_job(t, row, JobChange::kPlanned);
  if (plan.phase == Phase::kMesh) end_phase(t, row);
}

/// What is stored of a shard that is done.
struct Stored {
  std::int64_t token = 0;
  std::string digests;
};

std::optional<Stored> find_stored(SqlTransaction& t, const ShardKey& key) {
  const auto found = t.run(
      "SELECT token, digests FROM shards WHERE job_id = $1 AND phase = $2 AND number = $3 AND "
      "outcome = 1",
      {key.job, number_of(key.phase), key.number});
  if (found.rows.empty()) return std::nullopt;
  return Stored{found.rows[0].integer(0), found.rows[0].blob(1)};
}

absl::Status lost(const JobRow& row, const LeaseId& lease) {
  const std::string shard = text_of(lease.shard);
  if (is_finished(row.job.state)) {
    return lease_lost(absl::StrCat(shard, ": the job is ", name_of(row.job.state)));
  }
  return lease_lost(absl::StrCat(shard, ": token ", lease.token, " no longer holds it"));
}

absl::Status alarm(const ShardKey& shard) {
  return with_reason(absl::DataLossError(absl::StrCat(
                         text_of(shard), " was made with other bytes than are stored")),
                     "DETERMINISM_ALARM");
}

std::string join(std::span<const ChunkDigest> digests) { return absl::StrJoin(digests, ""); }

absl::Status check_digests(std::span<const ChunkDigest> digests) {
  const auto fits = [](const ChunkDigest& digest) { return digest.size() == kDigestBytes; };
  if (std::ranges::all_of(digests, fits)) return absl::OkStatus();
  return with_reason(absl::InvalidArgumentError("a chunk's digest has not 32 bytes"),
                     "INVALID_DIGESTS");
}

absl::Status check_count(const LeasedRow& shard, std::size_t digests) {
  if (static_cast<std::int64_t>(digests) == shard.chunks.size()) return absl::OkStatus();
  return with_reason(
      absl::InvalidArgumentError(absl::StrCat(text_of(shard.key), " has ", shard.chunks.size(),
                                              " chunks, but came with ", digests, " digests")),
      "INVALID_DIGESTS");
}

/// A commit without the lease: the repetition of one that was made, a late one, or the proof
/// that something is not deterministic, which is counted.
absl::Status late_commit(SqlTransaction& t,
                         JobRow& row,
                         const LeaseId& lease,
                         const std::string& digests,
                         bool& raise_alarm) {
  const auto stored = find_stored(t, lease.shard);
  if (!stored) return lost(row, lease);
  if (stored->digests == digests) {
    return stored->token == lease.token ? absl::OkStatus() : lost(row, lease);
  }
  raise_alarm = true;
  ++row.job.alarms;
  save_job(t, row, JobChange::kAlarm);
  return absl::OkStatus();
}

void commit_shard(SqlTransaction& t,
                  JobRow& row,
                  const LeasedRow& shard,
                  const std::string& digests) {
  settle(t, shard, ShardOutcome::kDone, absl::OkStatus(), digests);
  ++row.job.done_shards;
  if (shard.key.phase == Phase::kMesh) row.job.done_chunks += shard.chunks.size();
  save_job(t, row, JobChange::kShardDone);
  end_phase(t, row);
}

void bury(SqlTransaction& t, JobRow& row, const LeasedRow& shard, const absl::Status& error) {
  settle(t, shard, ShardOutcome::kDead, error, "");
  ++row.job.dead_shards;
  if (row.job.error.ok()) row.job.error = error;
  save_job(t, row, JobChange::kShardDead);
  end_phase(t, row);
}

/// Ready again at `due_us`.
void put_back(SqlTransaction& t,
              const LeasedRow& shard,
              ShardState state,
              std::int64_t due_us) {
  t.run(
      "UPDATE queue SET state = $4, due_us = $5 WHERE job_id = $1 AND phase = $2 AND number = "
      "$3",
      {shard.key.job, number_of(shard.key.phase), shard.key.number, number_of(state), due_us});
}

absl::Duration doubled(absl::Duration delay, std::int64_t times, absl::Duration most) {
  return std::min(delay * (std::int64_t{1} << std::clamp<std::int64_t>(times, 0, 30)), most);
}

absl::Duration delay_after(const SqlJobStore::Options& options, std::int64_t attempt) {
  return doubled(options.retry_delay, attempt - 1, options.max_retry_delay);
}

/// Tells the job of a shard that came back, and says how long that is left to nobody. It is no
/// change of the job's: no version of it, and no event.
absl::Duration note_give_back(SqlTransaction& t, const Job& job, const GiveBack& how) {
  if (how.why.ok()) return how.pause;
  const std::int64_t waits = t.integer(
      "UPDATE jobs SET given_back = given_back + 1, trouble = $2, room_waits = (room_waits + "
      "1) * $3 WHERE id = $1 RETURNING room_waits",
      {job.id, Blob{encode_status(how.why)}, std::int64_t{how.for_room ? 1 : 0}});
  if (!how.for_room) return how.pause;
  const std::int64_t left = job.shard_count - job.done_shards - job.dead_shards;
  return doubled(how.pause, (waits - 1) / std::max<std::int64_t>(left, 1), kLongestRoomPause);
}

/// The job is locked, so that it stays so.
bool holds(SqlTransaction& t, const LeaseId& lease) {
  return t.integer(
             "SELECT count(*) FROM queue WHERE job_id = $1 AND phase = $2 AND number = $3 AND "
             "token = $4 AND state = 1",
             {lease.shard.job, number_of(lease.shard.phase), lease.shard.number, lease.token}) >
         0;
}

/// Runs `body` with the job locked, and its shard if the lease still has it.
absl::Status with_shard(
    SqlDatabase& database,
    const LeaseId& lease,
    absl::FunctionRef<absl::Status(SqlTransaction&, JobRow&, const std::optional<LeasedRow>&)>
        body,
    Purpose purpose = Purpose::kWork) {
  return transact(
      database,
      [&](SqlTransaction& t) {
        auto row = lock_job(t, lease.shard.job);
        if (!row) return job_not_found(lease.shard.job);
        return body(t, *row, lock_leased(t, lease));
      },
      purpose);
}

std::vector<LeaseId> find_expired(SqlTransaction& t) {
  const auto found = t.run(
      "SELECT job_id, phase, number, token FROM queue WHERE state = 1 AND lease_us < $1 ORDER "
      "BY "
      "lease_us LIMIT $2",
      {t.now_us(), kRescuedAtOnce});
  std::vector<LeaseId> expired;
  for (const SqlRow& row : found.rows) {
    expired.push_back(
        {{row.text(0), phase_from(row.integer(1)), row.integer(2)}, row.integer(3)});
  }
  return expired;
}

/// The worker may have come back in the meantime.
bool is_expired(SqlTransaction& t, const LeasedRow& shard) {
  return t.integer(
             "SELECT lease_us FROM queue WHERE job_id = $1 AND phase = $2 AND number = $3",
             {shard.key.job, number_of(shard.key.phase), shard.key.number}) < t.now_us();
}

absl::Status expired_error(const LeasedRow& shard) {
  return with_reason(
      absl::UnavailableError(absl::StrCat(text_of(shard.key), ": worker ", shard.worker,
                                          " was not heard of in attempt ", shard.attempt)),
      "LEASE_EXPIRED");
}

}  // namespace

absl::Status SqlJobStore::set_plan(const LeaseId& lease, const Plan& plan) {
  if (auto status = check(plan); !status.ok()) return status;
  return with_shard(*database_, lease, [&](SqlTransaction& t, JobRow& row, const auto& shard) {
    if (!shard) {
      const auto stored = find_stored(t, lease.shard);
      return stored && stored->token == lease.token ? absl::OkStatus() : lost(row, lease);
    }
    if (shard->key.number > 0 && plan.phase == Phase::kCount) {
      return with_reason(
          absl::InvalidArgumentError(absl::StrCat("job ", row.job.id, " was counted already")),
          "INVALID_PLAN");
    }
    settle(t, *shard, ShardOutcome::kDone, absl::OkStatus(), "");
    begin_phase(t, row, plan);
    return absl::OkStatus();
  });
}

absl::Status SqlJobStore::complete(const LeaseId& lease, std::span<const ChunkDigest> digests) {
  if (auto status = check_digests(digests); !status.ok()) return status;
  bool raise_alarm = false;
  const absl::Status status =
      with_shard(*database_, lease, [&](SqlTransaction& t, JobRow& row, const auto& shard) {
        raise_alarm = false;
        if (!shard) return late_commit(t, row, lease, join(digests), raise_alarm);
        if (auto wrong = check_count(*shard, digests.size()); !wrong.ok()) return wrong;
        commit_shard(t, row, *shard, join(digests));
        return absl::OkStatus();
      });
  return status.ok() && raise_alarm ? alarm(lease.shard) : status;
}

absl::Status SqlJobStore::fail(const LeaseId& lease,
                               const absl::Status& error,
                               bool retryable) {
  return with_shard(
      *database_, lease,
      [&](SqlTransaction& t, JobRow& row, const auto& shard) {
        if (!shard) return lost(row, lease);
        if (retryable && shard->attempt < row.job.max_attempts) {
          put_back(t, *shard, ShardState::kBackingOff,
                   after_us(t.now_us(), delay_after(options_, shard->attempt)));
        } else {
          bury(t, row, *shard, error);
        }
        return absl::OkStatus();
      },
      Purpose::kRoom);
}

absl::Status SqlJobStore::fail_job(const LeaseId& lease, const absl::Status& error) {
  return transact(
      *database_,
      [&](SqlTransaction& t) {
        auto row = lock_job(t, lease.shard.job);
        if (!row) return job_not_found(lease.shard.job);
        if (!holds(t, lease)) return lost(*row, lease);
        row->job.dead_shards += bury_rest(t, row->job.id, error);
        row->job.error = error;
        finish(t, *row, JobState::kFailed);
        return absl::OkStatus();
      },
      Purpose::kRoom);
}

absl::Status SqlJobStore::release(const LeaseId& lease, const GiveBack& how) {
  return with_shard(
      *database_, lease,
      [&](SqlTransaction& t, JobRow& row, const auto& shard) {
        if (!shard) return lost(row, lease);
        const absl::Duration pause = note_give_back(t, row.job, how);
        const bool at_once = pause <= absl::ZeroDuration();
        put_back(t, *shard, at_once ? ShardState::kReady : ShardState::kBackingOff,
                 after_us(t.now_us(), pause));
        t.run(
            "UPDATE queue SET attempt = attempt - 1 WHERE job_id = $1 AND phase = $2 AND "
            "number = "
            "$3",
            {lease.shard.job, number_of(lease.shard.phase), lease.shard.number});
        return absl::OkStatus();
      },
      Purpose::kRoom);
}

absl::Status SqlJobStore::found_room(const LeaseId& lease) {
  return transact(*database_, [&](SqlTransaction& t) {
    const auto row = lock_job(t, lease.shard.job);
    if (!row) return job_not_found(lease.shard.job);
    if (!holds(t, lease)) return lost(*row, lease);
    t.run("UPDATE jobs SET room_waits = 0 WHERE id = $1 AND room_waits > 0", {row->job.id});
    return absl::OkStatus();
  });
}

absl::StatusOr<std::int64_t> SqlJobStore::rescue() {
  std::vector<LeaseId> expired;
  auto status = transact(*database_, [&](SqlTransaction& t) {
    expired = find_expired(t);
    return absl::OkStatus();
  });
  std::int64_t rescued = 0;
  for (auto lease = expired.begin(); status.ok() && lease != expired.end(); ++lease) {
    bool mine = false;
    status =
        with_shard(*database_, *lease, [&](SqlTransaction& t, JobRow& row, const auto& shard) {
          mine = shard && is_expired(t, *shard);
          if (!mine) return absl::OkStatus();
          if (shard->attempt < row.job.max_attempts) {
            put_back(t, *shard, ShardState::kReady, 0);
          } else {
            bury(t, row, *shard, expired_error(*shard));
          }
          return absl::OkStatus();
        });
    rescued += status.ok() && mine ? 1 : 0;
    if (absl::IsNotFound(status)) status = absl::OkStatus();  // deleted in the meantime
  }
  if (!status.ok()) return status;
  return rescued;
}

}  // namespace tet
