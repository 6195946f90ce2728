// The job store in SQL, over either engine: the rules of jobs, shards, leases and events.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <absl/time/time.h>

#include "server/jobs/store/job_room.h"
#include "server/jobs/store/job_store.h"
#include "server/jobs/store/sql.h"
#include "server/jobs/store/sql_transaction.h"

namespace tet {

/// What `planned` asks. It says the phase, since a database uses no partial index for a value
/// that it learns later.
inline constexpr char kPlannedJobs[] =
    "SELECT id, space, header, room_waits, (SELECT count(*) FROM queue WHERE queue.job_id = "
    "jobs.id AND queue.state = 1) FROM jobs WHERE state <= 2 AND phase = 2";

/// What `patient` asks, of so many looks and so many jobs; it says what its index says.
inline constexpr char kPatientJobs[] =
    "SELECT id, space, spec, rank FROM jobs WHERE state <= 2 AND phase = 0 AND room_waits > 0 "
    "AND room_waits >= $1 ORDER BY rank, id LIMIT $2";

/// Rows of `queue` are shards that somebody still has to do; those of `shards` are done or dead
/// letters. So what workers fight over stays small, and what is kept is only ever added to.
///
/// Rows are locked in one order, so that no transactions wait for each other in a circle: a
/// job, then its rows of `queue` by key. A claim takes rows of `queue` first, but never waits
/// for any lock.
class SqlJobStore final : public JobStore {
 public:
  /// A shard that failed is ready again after `retry_delay`, and twice that after each further
  /// failure, up to `max_retry_delay`.
  struct Options {
    absl::Duration retry_delay = absl::Seconds(1);
    absl::Duration max_retry_delay = absl::Minutes(1);
    /// Jobs that one namespace may have; by a hundredth of it more for each process that makes
    /// some.
    std::int64_t max_unfinished = INT64_MAX;
  };

  SqlJobStore(std::unique_ptr<SqlDatabase> database, Options options)
      : database_(std::move(database)), options_(options) {}

  absl::StatusOr<CreatedJob> create(const NewJob& wanted) override;
  absl::StatusOr<Job> get(const std::string& id) override;
  absl::StatusOr<JobPage> list(const ListJobs& query) override;
  absl::StatusOr<std::int64_t> queue_position(const std::string& id,
                                              std::int64_t most) override;
  absl::StatusOr<EventPage> watch(const WatchJobs& query) override;
  absl::StatusOr<std::int64_t> revision() override;
  absl::StatusOr<Job> cancel(const std::string& id) override;
  absl::StatusOr<Job> retry(const std::string& id,
                            std::span<const std::int64_t> lost_chunks) override;
  absl::Status remove(const std::string& id) override;
  absl::StatusOr<std::map<std::int64_t, ChunkDigest>> chunk_digests(const std::string& id,
                                                                    ChunkRange range) override;
  absl::StatusOr<std::vector<ChunkDigest>> count_digests(const std::string& id) override;
  absl::StatusOr<std::vector<DeadLetter>> dead_letters(const std::string& id) override;

  absl::StatusOr<std::vector<ShardLease>> claim(const ClaimShards& request) override;
  std::uint64_t signal() override { return database_->signal(); }
  void wait(std::uint64_t seen, absl::Duration timeout) override {
    database_->wait(seen, timeout);
  }
  void wake_all() override { database_->wake_all(); }
  absl::StatusOr<std::vector<LeaseState>> heartbeat(std::span<const LeaseId> leases,
                                                    absl::Duration lease) override;
  absl::StatusOr<std::vector<LeaseState>> look_at(std::span<const LeaseId> leases) override;
  absl::Status set_plan(const LeaseId& lease, const Plan& plan) override;
  absl::Status complete(const LeaseId& lease, std::span<const ChunkDigest> digests) override;
  absl::Status fail(const LeaseId& lease, const absl::Status& error, bool retryable) override;
  absl::Status fail_job(const LeaseId& lease, const absl::Status& error) override;
  using JobStore::release;
  absl::Status release(const LeaseId& lease, const GiveBack& how) override;
  absl::Status found_room(const LeaseId& lease) override;
  absl::Status plan_anew(const LeaseId& lease) override;
  absl::Status report(const WorkerReport& worker) override;
  absl::Status leave(const std::string& worker) override;
  absl::StatusOr<WorkerPage> workers(const ListWorkers& query) override;
  absl::StatusOr<std::string> belongs_to(const std::string& store) override;

  absl::StatusOr<std::int64_t> rescue() override;
  absl::StatusOr<std::int64_t> expire() override;
  absl::StatusOr<std::int64_t> replan(const std::string& algorithm) override;
  absl::StatusOr<std::int64_t> purge(absl::Duration finished_for) override;
  absl::StatusOr<StoreCounts> counts() override;
  absl::StatusOr<absl::Time> ask_time() override;
  absl::Time now() override { return database_->clock().now(); }
  absl::Status probe() override;
  absl::StatusOr<std::vector<PlannedJob>> planned() override;
  absl::StatusOr<std::vector<PatientJob>> patient() override;
  absl::StatusOr<std::set<JobInput>> inputs() override;

 private:
  absl::Status check_room(SqlTransaction& t, const std::string& space);
  absl::StatusOr<std::vector<Job>> list_some(const JobFilter& filter,
                                             const std::string& after,
                                             std::int64_t most);
  absl::Status number_all_events();
  absl::StatusOr<EventPage> read_events(const WatchJobs& query);

  const std::unique_ptr<SqlDatabase> database_;
  const Options options_;
  JobRoom room_;
};

}  // namespace tet
