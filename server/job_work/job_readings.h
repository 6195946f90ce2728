// What a server knows of jobs, as metrics.
#pragma once

#include <vector>

#include "server/job_work/job_worker.h"
#include "server/jobs/job_store.h"
#include "server/metrics.h"
#include "server/results/result_store.h"

namespace tet {

/// Of a store that does not answer, nothing.
std::vector<Reading> read_jobs(JobStore& jobs,
                               const ResultStore& results,
                               const JobWorker& worker);

}  // namespace tet
