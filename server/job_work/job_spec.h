// What is opaque to the job store, in words: what a job asks for, and what counting found.
#pragma once

#include <string>

#include <absl/status/statusor.h>

#include "server/jobs/job.h"
#include "server/planner.h"
#include "server/request.h"
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

/// A request's name: SHA-256 of what was asked for and the algorithm's version. Two requests of
/// one name ask for one mesh.
std::string name_of_request(const v1::MeshRequest& request);

/// Contiguous, and the same for every mesh of so many chunks.
std::vector<ChunkRange> shards_of(std::int64_t chunk_count);

}  // namespace tet
