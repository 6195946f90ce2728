// Batch jobs and their shards, in the words that the store, the workers and the service share.
#pragma once

#include <compare>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <absl/status/status.h>
#include <absl/time/time.h>

namespace tet {

/// Numbers are stored: they never change. A job ends in one of the states from kSucceeded on.
enum class JobState : std::int64_t {
  kQueued = 1,   ///< no shard of it has been claimed yet
  kRunning = 2,  ///< a shard was claimed
  kSucceeded = 3,
  kFailed = 4,  ///< some shards are dead letters, the others are done
  kCancelled = 5,
  kExpired = 6,  ///< not finished within its time to live
};

constexpr bool is_finished(JobState state) { return state >= JobState::kSucceeded; }

/// QUEUED, RUNNING, ...
std::string name_of(JobState state);

using Labels = std::map<std::string, std::string>;

/// A hundred years: the most that a `ttl` or `timeout` may be, so that no time that is made of
/// one is beyond what databases, clocks and the wire can say.
inline constexpr absl::Duration kLongestSpan = absl::Hours(24 * 365 * 100);

/// The most chunks that a job is believed to have: more tets than there is memory for.
inline constexpr std::int64_t kMostChunks = std::int64_t{1} << 40;

/// What a client asks for.
struct NewJob {
  std::string space;  ///< the namespace whose job it is; 1 to 128 printable ASCII
  std::string
      request_id;  ///< unique within the namespace: asking twice makes one job; may be empty
  std::string display_name;  ///< at most 256 bytes
  std::string spec;          ///< what to mesh; opaque here, at most 64 KiB
  /// Names of what the job reads, with a space between two: all must stay. At most 2400 bytes
  /// of printable ASCII.
  std::string input;
  Labels labels;              ///< at most 32
  std::int64_t priority = 0;  ///< -100 to 100, the highest first
  /// From creation to its end, else EXPIRED; at most kLongestSpan, or infinite. So is
  /// `timeout`, from the first claim on, else FAILED.
  absl::Duration ttl = absl::InfiniteDuration();
  absl::Duration timeout = absl::InfiniteDuration();
  std::int64_t max_attempts = 3;  ///< of each shard, 1 to 100
};

/// What a job reads, in its namespace.
struct JobInput {
  std::string space, name;
  auto operator<=>(const JobInput&) const = default;
};

struct Job {
  std::string id;  ///< 24 lower-case hexadecimal digits; ids sort by time of creation
  std::string space, display_name;
  std::string spec;
  std::string header;     ///< what `Plan` brought; empty before the plan
  std::string algorithm;  ///< whose plan it is; empty before the plan, and in stores of before
  Labels labels;
  std::int64_t priority = 0, max_attempts = 0;
  JobState state = JobState::kQueued;
  std::int64_t version = 0;  ///< 1, and one more with each event
  absl::Status error;        ///< of the first dead letter, or why the job was stopped
  absl::Time create_time;
  absl::Time start_time = absl::InfiniteFuture();  ///< of the first claim
  absl::Time plan_time = absl::InfiniteFuture();   ///< when its totals became known
  absl::Time finish_time =
      absl::InfiniteFuture();  ///< when it came to its state, if it is finished
  absl::Time stop_time =
      absl::InfiniteFuture();  ///< when it expires or times out, what is sooner
  std::int64_t chunk_count = 0, done_chunks = 0;  ///< of the mesh; 0 before the plan
  /// Shards of the present phase; those of shard_count that are in none of the others wait or
  /// back off.
  std::int64_t shard_count = 0, done_shards = 0, dead_shards = 0, leased_shards = 0;
  std::int64_t alarms = 0;      ///< shards that were made again with other bytes
  std::int64_t replans = 0;     ///< times that another algorithm version had to plan it again
  std::int64_t given_back = 0;  ///< shards, by workers that could not work themselves
  absl::Status trouble;         ///< why the last of these was given back
  /// A shard was given back for want of room, and since then nothing of the job has changed and
  /// none of its shards has found room.
  bool waits_for_room = false;
  absl::Time read_time = absl::InfinitePast();  ///< when the store was asked, by its clock
};

/// What a shard is for. Numbers are stored.
enum class Phase : std::int64_t {
  kPlan = 0,   ///< finds the totals and cuts the job into shards; every job begins with one
  kCount = 1,  ///< counts a range of a mesh too large for one host; then a plan shard follows
  kMesh = 2,   ///< makes a range of chunks; then the job has succeeded
};

/// A shard is the unit of claiming.
struct ShardKey {
  std::string job;
  Phase phase = Phase::kPlan;
  std::int64_t number = 0;  ///< within the phase
  auto operator<=>(const ShardKey&) const = default;
};

/// Contiguous, end exclusive: chunks of the mesh, or what the count phase divides.
struct ChunkRange {
  std::int64_t first = 0, end = 0;
  std::int64_t size() const { return end - first; }
  bool operator==(const ChunkRange&) const = default;
};

/// One claim of a shard. Tokens only grow: whoever holds a smaller one than was given out last
/// has been fenced off.
struct LeaseId {
  ShardKey shard;
  std::int64_t token = 0;
};

/// A worker's right to a shard until `expires`, by the store's clock.
struct ShardLease {
  LeaseId id;
  ChunkRange chunks;
  std::int64_t attempt = 0;  ///< 1 for the first
  absl::Time expires;
  std::string space = {};  ///< the job's namespace
};

/// The outcome of a plan shard: the next phase.
struct Plan {
  Phase phase = Phase::kMesh;      ///< kCount or kMesh
  std::string header;              ///< totals for the reader; opaque here, at most 64 KiB
  std::vector<ChunkRange> shards;  ///< contiguous from 0 on, none empty; at most 100,000
  /// Only workers of this algorithm version get the shards; at most 64 bytes, empty: all do.
  std::string algorithm = {};
};

/// What a worker says of itself now and then.
struct WorkerReport {
  std::string name;       ///< as in its claims
  std::string algorithm;  ///< the version of the meshes that it makes
  absl::Status trouble;   ///< why it takes nothing at present; OK: it works
};

/// A shard that a worker holds.
struct HeldShard {
  ShardKey shard;
  ChunkRange chunks;
  std::int64_t attempt = 0;
  absl::Time expires;
};

/// A worker as the store knows it.
struct KnownWorker {
  WorkerReport report;
  absl::Time seen;                     ///< when it reported last
  std::int64_t leased_shards = 0;      ///< of all namespaces
  std::vector<HeldShard> shards = {};  ///< of one namespace, the first of them
};

/// SHA-256 of a chunk's bytes, raw: 32 bytes.
using ChunkDigest = std::string;

/// A shard that is not tried again, and why.
struct DeadLetter {
  ShardKey shard;
  ChunkRange chunks;
  std::int64_t attempts = 0;
  std::string worker;  ///< the last that held it
  absl::Status error;
  absl::Time time;
};

/// What can happen to a job. Numbers are stored.
enum class JobChange : std::int64_t {
  kCreated = 1,
  kStarted = 2,
  kPlanned = 3,
  kShardDone = 4,
  kShardDead = 5,
  kFinished = 6,  ///< `state` says how
  kRetried = 7,
  kAlarm = 8,  ///< a shard was made again with other bytes than are stored
  kDeleted = 9,
  kReplanned = 10,  ///< by another algorithm version: nothing of it is done any more
};

/// One change of a job, with how the job stood after it.
struct JobEvent {
  std::int64_t revision = 0;  ///< global, without gaps in time: a later event has a larger one
  std::string job, space;
  std::int64_t version = 0;  ///< the job's
  JobChange change = JobChange::kCreated;
  JobState state = JobState::kQueued;
  std::int64_t chunk_count = 0, done_chunks = 0;
  std::int64_t shard_count = 0, done_shards = 0, dead_shards = 0;
  absl::Time time;
};

}  // namespace tet
