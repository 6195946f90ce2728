// What all calls about jobs share.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "server/jobs/results/result_store.h"
#include "server/jobs/service/job_notifier.h"
#include "server/jobs/store/job_store.h"
#include "server/jobs/work/job_health.h"
#include "server/rpc/client_tally.h"
#include "server/rpc/fair_tasks.h"
#include "server/streams/mesh_engine.h"

namespace tet {

struct JobContext {
  JobContext(MeshEngine& mesh_engine,
             JobStore& store,
             ResultStore& stored,
             const JobHealth& job_health)
      : engine(mesh_engine), jobs(store), results(stored), health(job_health) {}

  /// The job of that name, if it is in the namespace. Errors: kInvalidArgument (its name),
  /// kNotFound (JOB_NOT_FOUND), and the store's.
  absl::StatusOr<Job> find(const std::string& space, const std::string& name) const;

  /// The folder of a job's mesh, held; null before it is counted.
  absl::StatusOr<std::shared_ptr<MeshFolder>> mesh_of(const Job& job) const;
  /// Chunks that are done, but are not stored in the folder of the job's mesh any more.
  absl::StatusOr<std::vector<std::int64_t>> lost_chunks(const Job& job,
                                                        const MeshFolder* folder) const;

  MeshEngine& engine;
  JobStore& jobs;
  ResultStore& results;
  const JobHealth& health;
  JobNotifier notifier{jobs};
  ClientTally watches;  ///< WatchJobs under way
  FairTasks threads{pool, &engine.calls.clients()};
  TaskPool pool{4};  ///< its threads wait for the store, not for cores; ends before the above
};

}  // namespace tet
