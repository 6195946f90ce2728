// The store for what workers are: which of them are there, what store of files they need, and
// the jobs that none of them can go on with.
#include <map>
#include <string>
#include <vector>

#include "server/jobs/store/new_job.h"
#include "server/jobs/store/queue_rows.h"
#include "server/jobs/store/sql_job_store.h"
#include "server/jobs/store/store_errors.h"

namespace tet {

namespace {

constexpr char kStore[] = "store";
// Jobs planned again by one look.
constexpr std::int64_t kReplannedAtOnce = 500;

/// As it was before its first plan; what was asked for is all that is left. The job is locked.
void begin_again(SqlTransaction& t, JobRow& row) {
  drop_shards(t, row.job.id);
  t.run("UPDATE jobs SET header = $2 WHERE id = $1", {row.job.id, Blob{}});
  row.phase = Phase::kPlan;
  row.job.algorithm.clear();
  ++row.job.replans;
  row.job.error = absl::OkStatus();
  row.job.plan_time = absl::InfiniteFuture();
  row.job.chunk_count = row.job.done_chunks = 0;
  row.job.shard_count = 1;
  row.job.done_shards = row.job.dead_shards = 0;
  add_to_queue(t, row, Phase::kPlan, 0, {{0, 0}});
  save_job(t, row, JobChange::kReplanned);
}

/// Whether a worker lives that can go on with what this version began.
bool has_worker(SqlTransaction& t, const std::string& algorithm) {
  return !t.run("SELECT name FROM workers WHERE algorithm = $1 AND seen_us >= $2 LIMIT 1",
                {algorithm, after_us(t.now_us(), -kWorkerAlive)})
              .rows.empty();
}

/// Unfinished jobs of other versions that have no worker, if this one has.
std::vector<std::string> find_orphans(SqlTransaction& t, const std::string& own) {
  std::vector<std::string> orphans;
  if (!has_worker(t, own)) return orphans;
  const auto versions = t.run(
      "SELECT DISTINCT algorithm FROM jobs WHERE state <= 2 AND algorithm <> '' AND algorithm "
      "<> $1",
      {own});
  for (const SqlRow& version : versions.rows) {
    if (has_worker(t, version.text(0))) continue;
    const auto found =
        t.run("SELECT id FROM jobs WHERE state <= 2 AND algorithm = $1 ORDER BY id LIMIT $2",
              {version.text(0), kReplannedAtOnce});
    for (const SqlRow& row : found.rows) orphans.push_back(row.text(0));
  }
  return orphans;
}

/// Whether it still was one.
bool adopt(SqlTransaction& t, const std::string& id, const std::string& own) {
  auto row = lock_job(t, id);
  if (!row || is_finished(row->job.state)) return false;
  const std::string& algorithm = row->job.algorithm;
  if (algorithm.empty() || algorithm == own || has_worker(t, algorithm)) return false;
  begin_again(t, *row);
  return true;
}

/// The page's workers, without what they hold.
void read_workers(SqlTransaction& t, const ListWorkers& query, WorkerPage& page) {
  const auto found = t.run(
      "SELECT name, algorithm, trouble, seen_us FROM workers WHERE name > $1 AND seen_us >= $2 "
      "ORDER BY name LIMIT $3",
      {query.after, after_us(t.now_us(), -kWorkerForgotten), query.page_size + 1});
  page.is_last = std::ssize(found.rows) <= query.page_size;
  for (const SqlRow& row : found.rows) {
    if (std::ssize(page.workers) == query.page_size) break;
    page.workers.push_back(
        {{row.text(0), row.text(1), decode_status(row.blob(2))}, from_us(row.integer(3))});
  }
}

// The first shards of each worker in one namespace.
constexpr char kNamedShards[] =
    "SELECT worker, job_id, phase, number, first_chunk, end_chunk, attempt, lease_us FROM "
    "(SELECT *, row_number() OVER (PARTITION BY worker ORDER BY job_id, phase, number) AS "
    "place "
    "FROM queue WHERE state = 1 AND space = $1) AS held WHERE place <= $2 "
    "ORDER BY job_id, phase, number";

/// What the page's workers hold. Leases are as few as there are threads, so all are looked at.
void add_leases(SqlTransaction& t, const ListWorkers& query, WorkerPage& page) {
  std::map<std::string, KnownWorker*> by_name;
  for (KnownWorker& worker : page.workers) by_name[worker.report.name] = &worker;
  const auto of = [&](const SqlRow& row) {
    const auto found = by_name.find(row.text(0));
    return found == by_name.end() ? nullptr : found->second;
  };
  const auto counts =
      t.run("SELECT worker, count(*) FROM queue WHERE state = 1 GROUP BY worker");
  for (const SqlRow& row : counts.rows) {
    if (KnownWorker* worker = of(row)) worker->leased_shards = row.integer(1);
  }
  for (const SqlRow& row : t.run(kNamedShards, {query.space, kMostNamedShards}).rows) {
    KnownWorker* worker = of(row);
    if (worker == nullptr) continue;
    worker->shards.push_back({{row.text(1), phase_from(row.integer(2)), row.integer(3)},
                              range_from(row.integer(4), row.integer(5)),
                              bounded(row.integer(6), 0, kMaxAttempts),
                              from_us(row.integer(7))});
  }
}

}  // namespace

absl::Status SqlJobStore::plan_anew(const LeaseId& lease) {
  return transact(*database_, [&](SqlTransaction& t) {
    auto row = lock_job(t, lease.shard.job);
    if (!row) return job_not_found(lease.shard.job);
    if (!lock_leased(t, lease)) return lease_lost("somebody else has the shard of this plan");
    begin_again(t, *row);
    return absl::OkStatus();
  });
}

absl::StatusOr<std::int64_t> SqlJobStore::replan(const std::string& algorithm) {
  std::vector<std::string> orphans;
  auto status = transact(*database_, [&](SqlTransaction& t) {
    orphans = find_orphans(t, algorithm);
    return absl::OkStatus();
  });
  std::int64_t replanned = 0;
  for (auto id = orphans.begin(); status.ok() && id != orphans.end(); ++id) {
    bool mine = false;
    status = transact(*database_, [&](SqlTransaction& t) {
      mine = adopt(t, *id, algorithm);
      return absl::OkStatus();
    });
    replanned += status.ok() && mine ? 1 : 0;
  }
  if (!status.ok()) return status;
  return replanned;
}

absl::Status SqlJobStore::report(const WorkerReport& worker) {
  return transact(*database_, [&](SqlTransaction& t) {
    t.run(
        "INSERT INTO workers (name, algorithm, trouble, seen_us) VALUES ($1, $2, $3, $4) ON "
        "CONFLICT (name) DO UPDATE SET algorithm = $2, trouble = $3, seen_us = $4",
        {worker.name, worker.algorithm, Blob{encode_status(worker.trouble)}, t.now_us()});
    return absl::OkStatus();
  });
}

absl::Status SqlJobStore::leave(const std::string& worker) {
  return transact(*database_, [&](SqlTransaction& t) {
    t.run("DELETE FROM workers WHERE name = $1", {worker});
    return absl::OkStatus();
  });
}

absl::StatusOr<WorkerPage> SqlJobStore::workers(const ListWorkers& query) {
  WorkerPage page;
  const absl::Status status = transact(*database_, [&](SqlTransaction& t) {
    page = {};
    page.read_time = from_us(t.now_us());
    read_workers(t, query, page);
    add_leases(t, query, page);
    return absl::OkStatus();
  });
  if (!status.ok()) return status;
  return page;
}

absl::StatusOr<std::string> SqlJobStore::belongs_to(const std::string& store) {
  std::string found;
  const auto ask = [&](SqlTransaction& t) {
    const auto rows = t.run("SELECT value FROM facts WHERE name = $1", {kStore}).rows;
    found = rows.empty() ? "" : rows[0].text(0);
    return absl::OkStatus();
  };
  absl::Status status = read(*database_, ask);
  if (status.ok() && found.empty() && !store.empty()) {
    status = transact(*database_, [&](SqlTransaction& t) {
      t.run("INSERT INTO facts (name, value) VALUES ($1, $2) ON CONFLICT DO NOTHING",
            {kStore, store});
      return ask(t);
    });
  }
  if (!status.ok()) return status;
  return found;
}

}  // namespace tet
