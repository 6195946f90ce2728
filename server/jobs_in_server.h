// Batch jobs as a server has them: their service, over what a worker has too.
#pragma once

#include <memory>
#include <set>
#include <vector>

#include <absl/status/statusor.h>

#include "server/jobs/service/job_service.h"
#include "server/jobs/work/job_health.h"
#include "server/jobs/work/job_janitor.h"
#include "server/jobs/work/job_readings.h"
#include "server/jobs/work/job_worker.h"
#include "server/jobs/work/work_place.h"
#include "server/ops/config.h"

namespace tet {

/// The store of the jobs, their results, and whoever works on them, in the order in which they
/// are needed. The engine outlives it.
struct JobsAtWork {
  /// Null where the settings turn jobs off. Errors: those of open_job_store and
  /// ResultStore::open; kFailedPrecondition (WRONG_STORE) if the jobs belong to another store
  /// than the server's own.
  static absl::StatusOr<std::unique_ptr<JobsAtWork>> open(const Config& config,
                                                          MeshEngine& engine,
                                                          StoreUse use);

  JobsAtWork(const Config& config,
             MeshEngine& engine,
             std::unique_ptr<JobStore> jobs,
             std::unique_ptr<WorkPlace> work_place,
             std::unique_ptr<ResultStore> stored);

  std::vector<Reading> readings() const { return read_jobs(*store, *results, janitor, worker); }

  const std::unique_ptr<JobStore> store;
  const std::unique_ptr<WorkPlace> place;
  const std::unique_ptr<ResultStore> results;
  ShardMaker maker;
  JobJanitor janitor;
  JobWorker worker;
};

/// Grids that jobs need which are not finished. Errors: the store's.
absl::StatusOr<std::set<GridKey>> grids_of_jobs(JobStore& jobs);

struct JobsInServer {
  JobsInServer(std::unique_ptr<JobsAtWork> at_work, MeshEngine& engine, GridStore& grids)
      : work(std::move(at_work)),
        health(*work->store, *work->place, *work->results),
        context(engine, *work->store, *work->results, health),
        service(context, grids) {}

  /// `tetstream_jobs_up`: what is known without asking.
  Reading up() const;

  const std::unique_ptr<JobsAtWork> work;
  JobHealth health;
  JobContext context;
  JobService service;
};

}  // namespace tet
