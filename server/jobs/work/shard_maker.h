// What a worker does with a shard: have the mesh or a part of it counted, or make chunks of it;
// and store what came out.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <absl/functional/function_ref.h>
#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "server/jobs/results/job_spec.h"
#include "server/jobs/results/result_store.h"
#include "server/jobs/store/job_store.h"
#include "server/jobs/work/mesh_counter.h"
#include "server/jobs/work/shared_survey.h"
#include "server/jobs/work/work_place.h"
#include "server/streams/mesh_engine.h"

namespace tet {

/// Does shards, one on each thread that calls it; none of it is on the engine's pool but
/// counting, of which there is one at a time.
///
/// What a shard of the same mesh left is taken instead of being made again, whichever job had
/// it made, unless the job says otherwise.
///
/// Thread safety: any thread may call any member. What it refers to outlives it.
class ShardMaker {
 public:
  ShardMaker(MeshEngine& engine, JobStore& jobs, ResultStore& results, WorkPlace& place)
      : engine_(engine),
        jobs_(jobs),
        results_(results),
        place_(place),
        counter_(engine),
        block_bricks_(static_cast<std::int64_t>(engine.config.job_count_bricks)) {}

  /// Does the shard and commits it. Errors: what the shard fails with; kAborted (LEASE_LOST);
  /// kCancelled (`watch`).
  absl::Status run(const ShardLease& lease, const std::shared_ptr<PlanningWatch>& watch);

  /// Whether a shard that failed so may succeed when it is tried again.
  static bool is_worth_another_try(const absl::Status& error);
  /// Whether nothing more of the job is to be made: the room is another's.
  static bool ends_job(const absl::Status& error);
  /// Whether it failed only for want of a disk or a database that takes what was made.
  static bool lacks_room(const absl::Status& error);
  /// Whether it is the mesh that finds no room among others, and no fault of the worker's.
  static bool awaits_room(const absl::Status& error);

 private:
  struct Shard;

  absl::Status plan(const Shard& shard);
  absl::Status divide(const Shard& shard, std::int64_t blocks);
  absl::Status survey(const Shard& shard);
  absl::Status mesh(const Shard& shard);
  absl::Status commit(const Shard& shard, absl::FunctionRef<absl::Status()> tell);
  absl::Status commit_chunks(const Shard& shard, const std::vector<ChunkDigest>& digests);
  bool is_stored(const std::string& space, const stored::JobPlan& plan) const;
  absl::Status commit_plan(const Shard& shard, const stored::JobPlan& plan);
  absl::StatusOr<ChunkDigest> survey_block(const Shard& shard,
                                           SharedSurvey& survey,
                                           std::int64_t block);
  absl::StatusOr<std::shared_ptr<SharedSurvey>> survey_of(const Shard& shard);
  absl::StatusOr<PlannedMesh> count(const Shard& shard);
  absl::Status check_size(const MeshHeader& header) const;
  absl::Status check_room(const Shard& shard, const stored::JobPlan& plan) const;
  absl::Status give_way(const Shard& shard, const absl::Status& why) const;
  absl::StatusOr<std::vector<ChunkDigest>> make_chunks(const Shard& shard,
                                                       const PlannedMesh& planned,
                                                       MeshFolder& folder);

  MeshEngine& engine_;
  JobStore& jobs_;
  ResultStore& results_;
  WorkPlace& place_;
  MeshCounter counter_;
  const std::int64_t block_bricks_;
};

}  // namespace tet
