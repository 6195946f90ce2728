// What is opaque to the job store, in words: what a job asks for, and what counting found.
#pragma once

#include <string>

#include <absl/status/statusor.h>

#include "proto/convert/request.h"
#include "server/jobs/store/job.h"
#include "server/meshing/planner.h"
#include "tetstream/stored/jobs.pb.h"

namespace tet {

namespace stored = ::tetstream::stored;

/// Errors: kInternal (JOB_STORE_BROKEN: it was not written by this program).
absl::StatusOr<stored::JobSpec> spec_of(const Job& job);
absl::StatusOr<stored::JobPlan> plan_of(const Job& job);

/// The mesh that a job asks for, in its namespace.
absl::StatusOr<MeshOrder> order_of(const Job& job, const stored::JobSpec& spec);

/// What is kept of a counted mesh.
stored::JobPlan plan_of(const PlannedMesh& planned);

/// The trailer of a stream of chunks [first, end).
v1::MeshEvent trailer_event(const stored::JobPlan& plan,
                            std::uint64_t first,
                            std::uint64_t end,
                            const QualityStats& quality);

/// Cuts a mesh into shards: contiguous, and by the number of its chunks alone.
std::vector<ChunkRange> shards_of(std::int64_t chunk_count);

/// Cuts a survey into shards: one for each block, unless there are more blocks than a job is to
/// have shards.
std::vector<ChunkRange> count_shards_of(std::int64_t block_count);

}  // namespace tet
