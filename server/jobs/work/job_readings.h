// What a server knows of jobs, as metrics.
#pragma once

#include <vector>

#include "server/jobs/results/result_store.h"
#include "server/jobs/store/job_store.h"
#include "server/jobs/work/job_janitor.h"
#include "server/jobs/work/job_worker.h"
#include "server/ops/metrics.h"

namespace tet {

/// Reads the metrics of jobs; a store that does not answer contributes none.
std::vector<Reading> read_jobs(JobStore& jobs,
                               const ResultStore& results,
                               const JobJanitor& janitor,
                               const JobWorker& worker);

}  // namespace tet
