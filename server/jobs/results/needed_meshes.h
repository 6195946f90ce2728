// What unfinished jobs need of the results: meshes that they have made in part, or are to make.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "core/mesh/tet_mesh.h"
#include "server/jobs/results/result_store.h"
#include "server/jobs/store/job_store.h"

namespace tet {

struct NeededMesh {
  std::string job;
  ResultKey key;
  std::uint64_t bytes = 0;  ///< of the files of all its chunks, or a little more
  bool waits = false;       ///< for room, since its last shard was done
  bool goes_on = false;     ///< somebody makes a shard of it, and it does not wait
};

/// The meshes of all unfinished jobs that are counted. Errors: the store's.
absl::StatusOr<std::vector<NeededMesh>> needed_meshes(JobStore& jobs);

/// Their keys.
absl::StatusOr<std::set<ResultKey>> needed_results(JobStore& jobs);

/// The mesh that has the room which becomes free before that of `asking` has: the first of
/// those that have waited long, of a job that is more urgent or as urgent and older. None where
/// nobody comes first. One that finds no room on the disk if all other results go, since
/// somebody else has filled it, keeps nobody waiting. Errors: the store's.
absl::StatusOr<std::optional<NeededMesh>> first_in_line(JobStore& jobs,
                                                        ResultStore& results,
                                                        const Job& asking);

/// What the chunks take by themselves.
std::uint64_t chunk_bytes(const MeshHeader& header);

/// What the files of all chunks take, or a little more.
std::uint64_t stored_bytes(const MeshHeader& header);

/// The bytes of `meshes` together with one more, each counted once.
std::uint64_t bytes_beside(const std::vector<NeededMesh>& meshes,
                           const ResultKey& key,
                           std::uint64_t bytes);

/// Whether this job, which finds no room, and others wait for each other's, and it is the
/// youngest of them. As long as any job goes on it may end, and make room.
bool is_youngest_of_waiting(const std::vector<NeededMesh>& meshes, const std::string& job);

/// Whether a status says that results find no room beside others.
bool is_want_of_room(const absl::Status& status);

}  // namespace tet
