// Jobs as a C++ program uses them: made once however often asked for, followed, and read.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "client/library/mesh_client.h"
#include "client/library/part_receiver.h"
#include "core/base/cancel.h"
#include "tetstream/v1/jobs.pb.h"

namespace tet {

/// Names are `jobs/{id}`. Broken calls are taken up again as by MeshClient, and errors are of
/// the same kinds; docs/jobs.md has the reasons. Thread safety: any thread may call any member.
class JobClient {
 public:
  /// What tells how long an attempt lasted.
  using Clock = std::function<std::chrono::steady_clock::time_point()>;

  explicit JobClient(std::shared_ptr<Connection> connection,
                     Clock clock = &std::chrono::steady_clock::now);
  ~JobClient();

  /// Makes the job, or finds the one that was made under this `request_id`, which must not be
  /// empty: else a lost answer would make a second one.
  absl::StatusOr<v1::Job> create(const v1::Job& job,
                                 const std::string& request_id,
                                 const Cancellation& cancellation);

  absl::StatusOr<v1::Job> get(const std::string& name, const Cancellation& cancellation);
  absl::StatusOr<v1::Job> cancel(const std::string& name, const Cancellation& cancellation);
  absl::StatusOr<v1::Job> retry(const std::string& name, const Cancellation& cancellation);
  absl::Status remove(const std::string& name, const Cancellation& cancellation);

  /// One page.
  absl::StatusOr<v1::ListJobsResponse> list(const v1::ListJobsRequest& request,
                                            const Cancellation& cancellation);

  /// The last revision there is: whoever watches all jobs from here on misses no change of what
  /// is read later.
  absl::StatusOr<std::int64_t> revision(const Cancellation& cancellation);

  /// All dead shards of a job, by their first chunk.
  absl::StatusOr<std::vector<v1::DeadShard>> dead_shards(const std::string& name,
                                                         const Cancellation& cancellation);

  /// All workers, by name. They are told as they were at the `read_time` of the last page.
  absl::StatusOr<v1::ListWorkersResponse> workers(const Cancellation& cancellation);

  /// Calls `see` with each change after `after_revision`, of one job or (with an empty name) of
  /// all, once and in order, until it returns false or the watched job is deleted. A watch that
  /// breaks is taken up after the last change that came, however often where each lasted a
  /// while.
  absl::Status watch(const std::string& name,
                     std::int64_t after_revision,
                     const std::function<bool(const v1::JobEvent&)>& see,
                     const Cancellation& cancellation);

  /// The mesh of a job that has succeeded; only `progress.tets` is told.
  absl::StatusOr<StreamedMesh> read_result(const std::string& name,
                                           const ClientProgress& progress,
                                           const Cancellation& cancellation);

  /// Reads the mesh in parts, none of which is kept: up to `streams` ranges of chunks are read
  /// side by side, each in its order. `sink` is called by one thread at a time. `job` is as
  /// `get` told it.
  absl::Status read_parts(const v1::Job& job,
                          int streams,
                          const PartSink& sink,
                          const ClientProgress& progress,
                          const Cancellation& cancellation);

 private:
  std::shared_ptr<Connection> connection_;
  Clock clock_;
};

}  // namespace tet
