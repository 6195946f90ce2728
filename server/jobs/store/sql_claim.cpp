// The store for workers who look for work: claims, shared fairly among namespaces, and
// heartbeats.
#include <algorithm>
#include <map>
#include <set>

#include <absl/strings/str_cat.h>

#include "proto/convert/status.h"
#include "server/jobs/store/queue_rows.h"
#include "server/jobs/store/share_out.h"
#include "server/jobs/store/sql_job_store.h"

namespace tet {

namespace {

// Namespaces with something ready at one rank: the index is stepped from one to the next.
constexpr char kSpacesOfRank[] =
    "WITH RECURSIVE step (space) AS (SELECT min(space) FROM queue WHERE state = 0 AND rank = "
    "$1 "
    "UNION ALL SELECT (SELECT min(space) FROM queue WHERE state = 0 AND rank = $1 AND space "
    "> "
    "step.space) FROM step WHERE step.space IS NOT NULL) SELECT space FROM step WHERE "
    "space "
    "IS NOT NULL";

absl::Status check_lease(absl::Duration lease) {
  if (lease > absl::ZeroDuration() && lease <= absl::Hours(24)) return absl::OkStatus();
  return invalid_field(absl::StrCat("lease ", absl::FormatDuration(lease),
                                    " is not positive and at most 24 hours"));
}

absl::Status check(const ClaimShards& request) {
  if (request.worker.empty() || request.worker.size() > 128) {
    return invalid_field(absl::StrCat("worker '", request.worker, "' has not 1 to 128 bytes"));
  }
  if (request.max_shards < 1 || request.max_shards > 1000) {
    return invalid_field(
        absl::StrCat("max_shards ", request.max_shards, " is not from 1 to 1000"));
  }
  return check_lease(request.lease);
}

/// Shards whose delay is over are ready again.
void wake(SqlTransaction& t) {
  t.run(
      absl::StrCat("WITH due AS MATERIALIZED (SELECT job_id AS j, phase AS p, number AS n FROM "
                   "queue WHERE state = 2 AND due_us <= $1",
                   t.dialect().skip_locked(),
                   ") UPDATE queue SET state = 0 FROM due WHERE job_id = j AND phase = p AND "
                   "number = n"),
      {t.now_us()});
}

/// An idle worker looks again and again: that must not make the disk work.
bool is_any_ready(SqlTransaction& t, const std::string& algorithm) {
  return !t.run(
               "SELECT number FROM queue WHERE state = 0 AND ($1 = '' OR algorithm = '' OR "
               "algorithm = $1) LIMIT 1",
               {algorithm})
              .rows.empty();
}

/// One claim's transaction: rank by rank, each namespace's oldest shards.
class Claiming {
 public:
  Claiming(SqlTransaction& t, const ClaimShards& request)
      : t_(t),
        request_(request),
        token_(t.integer(t.dialect().next_token())),
        expires_us_(after_us(t.now_us(), request.lease)) {}

  std::vector<ShardLease> run() {
    count_leases();
    std::int64_t rank = INT64_MIN;
    while (room() > 0 && next_rank(rank)) claim_rank(rank);
    start_jobs();
    return std::move(leases_);
  }

 private:
  std::int64_t room() const { return request_.max_shards - std::ssize(leases_); }

  void count_leases() {
    const auto counts =
        t_.run("SELECT space, count(*) FROM queue WHERE state = 1 GROUP BY space");
    for (const SqlRow& row : counts.rows) held_[row.text(0)] = row.integer(1);
  }

  bool next_rank(std::int64_t& rank) {
    const auto next = t_.run(
        "SELECT rank FROM queue WHERE state = 0 AND rank > $1 ORDER BY rank LIMIT 1", {rank});
    if (next.rows.empty()) return false;
    rank = next.rows[0].integer(0);
    return true;
  }

  void claim_rank(std::int64_t rank) {
    std::map<std::string, std::int64_t> held;
    for (const SqlRow& row : t_.run(kSpacesOfRank, {rank}).rows) {
      const std::string space = row.text(0);
      if (!request_.not_of.contains(space)) held[space] = held_[space];
    }
    while (room() > 0 && !held.empty()) {
      for (const auto& [space, share] : share_out(room(), held)) {
        const std::int64_t got = take(rank, space, share);
        held[space] = held_[space] += got;
        if (got < share) held.erase(space);
      }
    }
  }

  std::int64_t take(std::int64_t rank, const std::string& space, std::int64_t most) {
    const auto taken = t_.run(
        absl::StrCat(
            "WITH picked AS MATERIALIZED (SELECT job_id AS j, phase AS p, number AS n FROM "
            "queue "
            "WHERE state = 0 AND rank = $1 AND space = $2 AND ($7 = '' OR algorithm = '' OR "
            "algorithm = $7) ORDER BY job_id, phase, number LIMIT $3",
            t_.dialect().skip_locked(),
            ") UPDATE queue SET state = 1, token = $4, worker = $5, attempt = attempt + 1, "
            "lease_us = $6 FROM picked WHERE job_id = j AND phase = p AND number = n RETURNING "
            "job_id, phase, number, first_chunk, end_chunk, attempt"),
        {rank, space, most, token_, request_.worker, expires_us_, request_.algorithm});
    for (const SqlRow& row : taken.rows) {
      const ShardKey key{row.text(0), phase_from(row.integer(1)), row.integer(2)};
      leases_.push_back({{key, token_},
                         range_from(row.integer(3), row.integer(4)),
                         row.integer(5),
                         from_us(expires_us_),
                         space});
    }
    return std::ssize(taken.rows);
  }

  /// A queued job of which a shard was claimed runs. One that somebody holds is being stopped,
  /// or started by another claim: in neither case is it ours to wait for.
  void start_jobs() {
    std::ranges::sort(leases_, {}, [](const ShardLease& l) { return l.id.shard; });
    std::set<std::string> jobs;
    for (const ShardLease& lease : leases_) jobs.insert(lease.id.shard.job);
    for (const std::string& id : jobs) {
      const auto queued = t_.run(absl::StrCat(select_jobs({}), " WHERE id = $1 AND state = 1",
                                              t_.dialect().skip_locked()),
                                 {id});
      if (queued.rows.empty()) continue;
      JobRow row = job_row(queued.rows[0]);
      row.job.state = JobState::kRunning;
      row.job.start_time = from_us(t_.now_us());
      row.job.stop_time =
          std::min(row.job.stop_time, from_us(after_us(t_.now_us(), row.timeout)));
      save_job(t_, row, JobChange::kStarted);
    }
  }

  SqlTransaction& t_;
  const ClaimShards& request_;
  const std::int64_t token_;  ///< one for the whole claim: no shard is claimed twice in it
  const std::int64_t expires_us_;
  std::map<std::string, std::int64_t> held_;  ///< leases that each namespace has
  std::vector<ShardLease> leases_;
};

bool extend(SqlTransaction& t, const LeaseId& lease, std::int64_t until_us) {
  return t.run(
              "UPDATE queue SET lease_us = $5 WHERE job_id = $1 AND phase = $2 AND number = $3 "
              "AND "
              "token = $4 AND state = 1",
              {lease.shard.job, number_of(lease.shard.phase), lease.shard.number, lease.token,
               until_us})
             .changed == 1;
}

}  // namespace

absl::StatusOr<std::vector<ShardLease>> SqlJobStore::claim(const ClaimShards& request) {
  if (auto status = check(request); !status.ok()) return status;
  std::vector<ShardLease> leases;
  const absl::Status status = transact(*database_, [&](SqlTransaction& t) {
    wake(t);
    leases.clear();
    if (is_any_ready(t, request.algorithm)) leases = Claiming(t, request).run();
    return absl::OkStatus();
  });
  if (!status.ok()) return status;
  return leases;
}

absl::StatusOr<std::vector<LeaseState>> SqlJobStore::heartbeat(std::span<const LeaseId> leases,
                                                               absl::Duration lease) {
  if (auto status = check_lease(lease); !status.ok()) return status;
  std::vector<std::size_t> order(leases.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::sort(order, {}, [&](std::size_t i) { return leases[i].shard; });
  std::vector<LeaseState> answers(leases.size(), LeaseState::kLost);
  const absl::Status status = transact(*database_, [&](SqlTransaction& t) {
    const std::int64_t until_us = after_us(t.now_us(), lease);
    for (const std::size_t i : order) {
      answers[i] = extend(t, leases[i], until_us) ? LeaseState::kHeld : LeaseState::kLost;
    }
    return absl::OkStatus();
  });
  if (!status.ok()) return status;
  return answers;
}

absl::StatusOr<std::vector<LeaseState>> SqlJobStore::look_at(std::span<const LeaseId> leases) {
  std::vector<LeaseState> answers;
  const absl::Status status = read(*database_, [&](SqlTransaction& t) {
    answers.clear();
    for (const LeaseId& lease : leases) {
      const bool held = !t.run(
                              "SELECT token FROM queue WHERE job_id = $1 AND phase = $2 AND "
                              "number = $3 AND token = $4 AND state = 1",
                              {lease.shard.job, number_of(lease.shard.phase),
                               lease.shard.number, lease.token})
                             .rows.empty();
      answers.push_back(held ? LeaseState::kHeld : LeaseState::kLost);
    }
    return absl::OkStatus();
  });
  if (!status.ok()) return status;
  return answers;
}

}  // namespace tet
