// Meshes that a server makes while nobody waits, to be read when they are done.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tetstream/client.h"
#include "tetstream/export.h"
#include "tetstream/mesh.h"
#include "tetstream/request.h"
#include "tetstream/scene.h"
#include "tetstream/status.h"
#include "tetstream/stream.h"

namespace tetstream {

/// How a job stands; the last four are final but for Jobs::retry.
enum class JobState : std::uint8_t {
  kQueued = 1,     ///< no worker has taken any of it
  kRunning = 2,    ///< a worker has taken some of it
  kSucceeded = 3,  ///< the mesh is stored
  kFailed = 4,
  kCancelled = 5,
  kExpired = 6,  ///< it was not finished within its time to live
};

/// Whether a job in this state is at its end.
constexpr bool is_final(JobState state) noexcept { return state >= JobState::kSucceeded; }

/// What happened to a job.
enum class JobChange : std::uint8_t {
  kCreated = 1,
  kStarted = 2,
  kPlanned = 3,  ///< its mesh is counted, or a phase of that ended
  kShardDone = 4,
  kShardDead = 5,
  kFinished = 6,
  kRetried = 7,
  kDeterminismAlarm = 8,
  kDeleted = 9,
  kReplanned = 10,
};

using JobLabels = std::map<std::string, std::string>;

/// How a mesh is made, beside its request.
struct JobOrder {
  std::string display_name = {};  ///< for people; at most 256 bytes
  /// At most 32: keys [a-z][a-z0-9_./-]*, values printable ASCII, both of at most 63 bytes.
  JobLabels labels = {};
  int priority = 0;  ///< -100 to 100; higher ones come first
  /// From its creation to its end; for ever unless given.
  std::optional<std::chrono::milliseconds> ttl = {};
  /// From when it runs to its end; none unless given.
  std::optional<std::chrono::milliseconds> timeout = {};
  std::optional<int> max_attempts =
      {};                   ///< at each of its shards: 1 to 100, and 3 unless given
  bool skip_cache = false;  ///< make it even where its result is stored
  /// Asking again with the same one gives the job that is there. Made up where it is empty.
  std::string request_id = {};
};

/// A mesh is counted, then made in shards, which are runs of chunks.
struct JobProgress {
  std::uint64_t chunk_count = 0;  ///< 0 until it is counted
  std::uint64_t done_chunks = 0;
  std::uint64_t shard_count = 0;
  std::uint64_t done_shards = 0;
  std::uint64_t running_shards = 0;
  std::uint64_t dead_shards = 0;  ///< that failed for good
  double chunks_per_second = 0;
  std::optional<double> eta_seconds = {};

  /// 0 to 1, of its chunks.
  double fraction() const noexcept {
    if (chunk_count == 0) return 0;
    return static_cast<double>(done_chunks) / static_cast<double>(chunk_count);
  }
};

/// A job as it stood when it was asked for.
struct Job {
  using Time = std::optional<std::chrono::system_clock::time_point>;

  std::string name;  ///< `jobs/{id}`
  JobOrder order;    ///< without its request_id, which the server does not tell
  JobState state = JobState::kQueued;
  std::uint64_t version = 0;  ///< one more with each change
  Time created = {}, started = {}, finished = {};
  /// How many jobs come before it. Not in lists, nor where the server does not count so far.
  std::optional<std::uint64_t> queue_position = {};
  JobProgress progress = {};
  Status error = {};    ///< why it has failed, was cancelled or has expired
  bool cached = false;  ///< its result was stored before it was made
  /// What is known of its mesh, once that is counted; lists leave it out.
  std::optional<MeshHeader> header = {};
};

struct JobEvent {
  std::int64_t revision = 0;  ///< grows from event to event, over all jobs
  std::string name;           ///< of the job
  std::uint64_t version = 0;  ///< that the job then had
  JobChange change = JobChange::kCreated;
  JobState state = JobState::kQueued;
  JobProgress progress = {};
  Job::Time time = {};
};

/// Which jobs are meant: those for which all holds that is set.
struct JobFilter {
  std::vector<JobState> states = {};  ///< any of these; all where it is empty
  JobLabels labels = {};              ///< that the job has
  std::string display_name_prefix = {};
  std::uint64_t most = 0;  ///< jobs to list; 0 lists all
};

struct JobList {
  std::vector<Job> jobs;      ///< the newest first
  std::int64_t revision = 0;  ///< watch from here on to miss no change of what was listed
};

/// The jobs of one server and namespace. Copies share the client's connection, and any thread
/// may call any member. Errors: those of Client, and the reasons that docs/errors.md lists.
class TETSTREAM_API Jobs {
 public:
  explicit Jobs(const Client& client);

  /// Queues a mesh. Fields and a scene's volumes are uploaded first.
  Result<Job> submit(const StoredVolume& volume,
                     const Request& request = {},
                     const JobOrder& order = {},
                     const WorkOptions& options = {}) const;
  Result<Job> submit(const Scene& scene,
                     const Request& request = {},
                     const JobOrder& order = {},
                     const WorkOptions& options = {}) const;

  Result<Job> get(const std::string& name, const WorkOptions& options = {}) const;
  Result<JobList> list(const JobFilter& filter = {}, const WorkOptions& options = {}) const;

  /// Waits until the job is at its end, however that is; `options.progress` is told of its
  /// chunks.
  Result<Job> wait(const std::string& name, const WorkOptions& options = {}) const;
  /// Calls `see` with each change after `after_revision`, of one job or, with an empty name, of
  /// all, in order, until it returns false or the watched job is deleted.
  Status watch(const std::string& name,
               std::int64_t after_revision,
               const std::function<bool(const JobEvent&)>& see,
               const WorkOptions& options = {}) const;

  /// Stops a job that is not at its end. Shards that are done are kept.
  Result<Job> cancel(const std::string& name, const WorkOptions& options = {}) const;
  /// Tries the shards again that failed or were stopped.
  Result<Job> retry(const std::string& name, const WorkOptions& options = {}) const;
  /// Forgets a job that is at its end.
  Status remove(const std::string& name, const WorkOptions& options = {}) const;

  /// Receives the mesh of a job that has succeeded. Errors also: kFailedPrecondition
  /// (JOB_NOT_SUCCEEDED), kDataLoss (a stored chunk is damaged: retry the job).
  Result<Mesh> fetch(const std::string& name, const WorkOptions& options = {}) const;
  /// Receives it chunk by chunk.
  MeshStream stream(const std::string& name,
                    const WorkOptions& options = {},
                    ChunkRange chunks = {}) const;

 private:
  std::shared_ptr<const Client::Impl> client_;
};

}  // namespace tetstream
