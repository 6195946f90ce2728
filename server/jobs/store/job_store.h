// Where batch jobs are kept: one interface, engines for one machine (SQLite) and for many
// (PostgreSQL), and one set of tests for both.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>
#include <absl/time/time.h>

#include "server/jobs/store/job.h"

namespace tet {

struct CreatedJob {
  Job job;
  bool existed = false;  ///< the same request had made it before
};

/// Everything that is set must hold.
struct JobFilter {
  std::string space = {};
  std::set<JobState> states = {};
  Labels labels = {};
  std::string name_prefix = {};  ///< of display_name
  absl::Time created_from = absl::InfinitePast();
  absl::Time created_before = absl::InfiniteFuture();
};

/// A page of anything ends where it has so many bytes: gRPC's clients take no more than 4 MiB
/// at once unless they are told to.
inline constexpr std::size_t kPageBytes = std::size_t{1} << 20;

struct ListJobs {
  JobFilter filter = {};
  std::int64_t page_size = 100;  ///< 1 to 1000; fewer come where they have kPageBytes
  std::string page_token = {};
};

struct JobPage {
  std::vector<Job> jobs;
  std::string next_page_token;  ///< empty on the last page
};

struct WatchJobs {
  std::int64_t after_revision = 0;
  std::string space = {};                      ///< empty watches all namespaces
  std::string job = {};                        ///< empty watches all
  std::int64_t limit = 1000;                   ///< 1 to 10,000 events
  absl::Duration wait = absl::ZeroDuration();  ///< for the first event
};

struct EventPage {
  std::vector<JobEvent> events;
  std::int64_t revision = 0;  ///< go on after this one, also when there were no events
};

struct ClaimShards {
  std::string worker;           ///< 1 to 128 bytes
  std::int64_t max_shards = 1;  ///< 1 to 1000
  absl::Duration lease = absl::Seconds(30);
  std::string algorithm = {};  ///< the version of the worker's meshes; empty takes any job's
  std::set<std::string> not_of = {};  ///< namespaces whose shards are left to others
};

/// What is kept of an unfinished job's plan, while its mesh is being made or waits to be.
struct PlannedJob {
  std::string id, space;
  std::string header;           ///< as `Plan` brought it
  bool waits_for_room = false;  ///< see Job
  std::int64_t leased_shards = 0;
};

/// A job that has looked for room for its mesh so often that others leave it what becomes free.
struct PatientJob {
  std::string id, space, spec;
  std::int64_t priority = 0;
};

/// So many looks in vain make a job patient: with pauses that grow from two seconds to a
/// minute, after three minutes or so.
inline constexpr std::int64_t kPatientLooks = 8;
/// So many patient jobs are told of: one of the first has the room.
inline constexpr std::int64_t kMostPatient = 16;

struct ListWorkers {
  std::string space = {};        ///< whose shards are named
  std::int64_t page_size = 100;  ///< 1 to 1000
  std::string after = {};        ///< the last worker of the page before
};

struct WorkerPage {
  std::vector<KnownWorker> workers;
  bool is_last = true;
  absl::Time read_time;
};

/// How a shard is given back that the worker did not do.
struct GiveBack {
  absl::Status why = {};                        ///< what the job says of it; OK: nothing
  absl::Duration pause = absl::ZeroDuration();  ///< until anybody may claim it again
  /// The job waits for room among the results, until something of it changes or `found_room`
  /// is called. The pause is twice as long each time that all shards which are left have
  /// waited, up to kLongestRoomPause, so that many jobs that wait are not much work.
  bool for_room = false;
};

inline constexpr absl::Duration kLongestRoomPause = absl::Minutes(1);

enum class LeaseState { kHeld, kLost };

/// Numbers for metrics.
struct StoreCounts {
  std::map<JobState, std::int64_t> jobs;
  std::int64_t ready_shards = 0;    ///< may be claimed now
  std::int64_t leased_shards = 0;   ///< held by a worker
  std::int64_t backing_off = 0;     ///< may be claimed again later
  std::int64_t dead_shards = 0;     ///< dead letters
  std::int64_t alarms = 0;          ///< determinism alarms
  absl::Duration oldest_ready_age;  ///< since its job was created; 0 when none is ready
  /// Workers that were heard of within kWorkerAlive, and those of them that take nothing.
  std::int64_t workers = 0, troubled_workers = 0;
};

/// A worker that did not report for so long is taken for dead.
inline constexpr absl::Duration kWorkerAlive = absl::Minutes(1);
/// And so long after that a janitor may forget it.
inline constexpr absl::Duration kWorkerForgotten = absl::Hours(24);
/// As many shards of a worker are named.
inline constexpr std::int64_t kMostNamedShards = 100;

/// Jobs, their shards, leases and events.
///
/// Every time is the store's own clock's. Every call is one short transaction or a few; when it
/// returns OK its effect survives a crash of this process, of the store's and of the machine. A
/// call that fails with kUnavailable may have had its effect; every one of them may be made
/// again.
///
/// Thread safety: every member may be called from any thread. Errors of all: kUnavailable
/// (JOB_STORE_UNAVAILABLE: try again), kResourceExhausted (JOB_STORE_FULL), kInternal
/// (JOB_STORE_BROKEN). Those that take a job: kNotFound (JOB_NOT_FOUND).
class JobStore {
 public:
  virtual ~JobStore() = default;

  // --- for clients ---

  /// Errors: kInvalidArgument (INVALID_FIELD), kAlreadyExists (REQUEST_ID_REUSED: the namespace
  /// made another job under this request_id), kResourceExhausted (QUOTA_EXCEEDED: too many jobs
  /// of the namespace are not finished).
  virtual absl::StatusOr<CreatedJob> create(const NewJob& job) = 0;
  virtual absl::StatusOr<Job> get(const std::string& id) = 0;
  /// The newest first. A job is on one page at most, and on one if it is there all the time.
  /// Errors: kInvalidArgument (INVALID_FIELD: page size; a token of another filter).
  virtual absl::StatusOr<JobPage> list(const ListJobs& query) = 0;
  /// Jobs that come before it, counted up to `most` of them; 0 unless it is queued.
  virtual absl::StatusOr<std::int64_t> queue_position(const std::string& id,
                                                      std::int64_t most = INT64_MAX) = 0;
  /// Events in the order of their revisions: whoever goes on after the last it saw misses none
  /// and sees none twice. Waits as long as told while there are none. Errors: kOutOfRange
  /// (REVISION_COMPACTED: events after this revision were purged; REVISION_UNKNOWN: it lies in
  /// the future).
  virtual absl::StatusOr<EventPage> watch(const WatchJobs& query) = 0;
  /// The last revision: watch from here, then get, and no change is missed.
  virtual absl::StatusOr<std::int64_t> revision() = 0;
  /// Stops a job; one that is finished stays as it is.
  virtual absl::StatusOr<Job> cancel(const std::string& id) = 0;
  /// Tries dead letters again, and shards that are done but lost some of these chunks' bytes
  /// since; with all their attempts, time to live and timeout anew. What else is done stays
  /// done. Errors: kFailedPrecondition (JOB_ACTIVE; JOB_SUCCEEDED, and nothing of it was lost),
  /// kResourceExhausted (QUOTA_EXCEEDED, as by `create`).
  virtual absl::StatusOr<Job> retry(const std::string& id,
                                    std::span<const std::int64_t> lost_chunks = {}) = 0;
  /// Forgets a job. Errors: kFailedPrecondition (JOB_ACTIVE).
  virtual absl::Status remove(const std::string& id) = 0;
  /// Digests of the chunks of shards that are done, by chunk: fewer than asked for where a
  /// shard is not done yet. Errors: kOutOfRange (RANGE_BEYOND_MESH).
  virtual absl::StatusOr<std::map<std::int64_t, ChunkDigest>> chunk_digests(
      const std::string& id, ChunkRange range) = 0;
  /// What the count phase stored, in the order of its shards.
  virtual absl::StatusOr<std::vector<ChunkDigest>> count_digests(const std::string& id) = 0;
  virtual absl::StatusOr<std::vector<DeadLetter>> dead_letters(const std::string& id) = 0;

  // --- for workers ---

  /// The highest priority first; within it, namespaces get equal shares of the leases; within a
  /// namespace the oldest job first. Errors: kInvalidArgument (INVALID_FIELD).
  virtual absl::StatusOr<std::vector<ShardLease>> claim(const ClaimShards& request) = 0;
  /// Grows with every commit that this process knows of.
  virtual std::uint64_t signal() = 0;
  /// Returns when `signal` is beyond `seen`, or at the timeout. An idle worker reads the
  /// signal, claims, and if it got nothing waits for what came after it had read.
  virtual void wait(std::uint64_t seen, absl::Duration timeout) = 0;
  /// Raises the signal of this process though nothing was committed: whoever waits is to end.
  virtual void wake_all() = 0;
  /// Extends leases that are still held; one answer for each. A lease past its time is held
  /// until somebody else got the shard.
  virtual absl::StatusOr<std::vector<LeaseState>> heartbeat(std::span<const LeaseId> leases,
                                                            absl::Duration lease) = 0;
  /// Which leases are still held, without extending them; writes nothing.
  virtual absl::StatusOr<std::vector<LeaseState>> look_at(std::span<const LeaseId> leases) = 0;
  /// Ends a plan shard and begins the next phase; a plan without shards ends the job.
  /// Errors: kInvalidArgument (INVALID_PLAN), and those of `complete`.
  virtual absl::Status set_plan(const LeaseId& lease, const Plan& plan) = 0;
  /// Commits a shard of the count or mesh phase: one digest a chunk. Committing again with the
  /// same token is OK and changes nothing. Errors: kAborted (LEASE_LOST: somebody else has or
  /// had the shard, or the job was stopped; throw the work away), kDataLoss (DETERMINISM_ALARM:
  /// the shard is stored with other bytes), kInvalidArgument (INVALID_DIGESTS).
  virtual absl::Status complete(const LeaseId& lease, std::span<const ChunkDigest> digests) = 0;
  /// The shard is tried again later, if `retryable` and attempts are left; else it is a dead
  /// letter that keeps `error`. Errors: kAborted (LEASE_LOST).
  virtual absl::Status fail(const LeaseId& lease,
                            const absl::Status& error,
                            bool retryable) = 0;
  /// Ends the shard's job FAILED with `error`: all that is left of it are dead letters. Errors:
  /// kAborted (LEASE_LOST).
  virtual absl::Status fail_job(const LeaseId& lease, const absl::Status& error) = 0;
  /// Gives a shard back untouched: the attempt does not count. Errors: kAborted (LEASE_LOST).
  virtual absl::Status release(const LeaseId& lease, const GiveBack& how) = 0;
  absl::Status release(const LeaseId& lease) { return release(lease, {}); }
  /// Room was found again for what the shard brings: its job no longer waits, though nothing of
  /// it is done yet. It is no change that watchers are told of. Errors: kAborted (LEASE_LOST).
  virtual absl::Status found_room(const LeaseId& lease) = 0;
  /// The job's plan is another algorithm version's: it is planned again, from what was asked
  /// for, and what was done of it is dropped. Errors: kAborted (LEASE_LOST).
  virtual absl::Status plan_anew(const LeaseId& lease) = 0;
  /// To be called every few seconds by whoever claims; `leave` when it ends.
  virtual absl::Status report(const WorkerReport& worker) = 0;
  virtual absl::Status leave(const std::string& worker) = 0;
  /// Workers that reported within kWorkerForgotten, by name, with what they hold.
  virtual absl::StatusOr<WorkerPage> workers(const ListWorkers& query) = 0;
  /// The identity of the store of files that the jobs belong to: `store`, unless another was
  /// named before. An empty `store` only asks, and the answer is empty while none was named.
  virtual absl::StatusOr<std::string> belongs_to(const std::string& store) = 0;

  // --- for janitors; any number of processes may, at any time ---

  /// Takes back shards whose lease is past its time, as if they had failed with kUnavailable
  /// (LEASE_EXPIRED). Says how many.
  virtual absl::StatusOr<std::int64_t> rescue() = 0;
  /// Ends jobs past their time to live (EXPIRED, with JOB_EXPIRED) or their timeout (FAILED,
  /// with JOB_TIMEOUT). Says how many.
  virtual absl::StatusOr<std::int64_t> expire() = 0;
  /// Plans jobs again, as by `plan_anew`, that are of an algorithm version that no living
  /// worker has, if one has this version. Says how many.
  virtual absl::StatusOr<std::int64_t> replan(const std::string& algorithm) = 0;
  /// Forgets jobs that have been finished for so long, and their events; an engine may keep
  /// some of them longer. Says how many.
  virtual absl::StatusOr<std::int64_t> purge(absl::Duration finished_for) = 0;
  virtual absl::StatusOr<StoreCounts> counts() = 0;
  /// Asks for the store's time.
  virtual absl::StatusOr<absl::Time> ask_time() = 0;
  /// The store's time without asking: what it said last, and what has passed since by the
  /// monotonic clock. The infinite past before it has said anything.
  virtual absl::Time now() = 0;
  /// OK if something can be written now.
  virtual absl::Status probe() = 0;
  /// The jobs that are not finished, of which the count phase is over.
  virtual absl::StatusOr<std::vector<PlannedJob>> planned() = 0;
  /// Unfinished jobs that have waited with their plan shard for kPatientLooks or more: the most
  /// urgent first, then the oldest, and kMostPatient of them at most.
  virtual absl::StatusOr<std::vector<PatientJob>> patient() = 0;
  /// What the jobs read that are not finished.
  virtual absl::StatusOr<std::set<JobInput>> inputs() = 0;
};

}  // namespace tet
