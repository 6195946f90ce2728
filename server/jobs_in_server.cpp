#include "server/jobs_in_server.h"

#include <filesystem>
#include <unistd.h>
#include <utility>

#include <absl/strings/str_cat.h>

#include "proto/convert/status.h"
#include "server/jobs/results/needed_meshes.h"
#include "server/jobs/store/open_job_store.h"

namespace tet {

namespace {

namespace fs = std::filesystem;

constexpr char kFile[] = "jobs.sqlite";
constexpr char kResults[] = "results";

/// Whose leases these are, for people.
std::string worker_name() {
  char host[64] = {};
  ::gethostname(host, sizeof host - 1);
  return absl::StrCat(host, ":", ::getpid());
}

SqlJobStore::Options job_rules(const Config& config) {
  SqlJobStore::Options rules;
  rules.max_unfinished = static_cast<std::int64_t>(config.max_namespace_jobs);
  return rules;
}

/// Jobs of another store know nothing of the meshes that are here.
absl::StatusOr<std::set<ResultKey>> needed_here(JobStore& jobs, WorkPlace& place) {
  const absl::Status found = place.check_store();
  if (!found.ok()) return found;
  return needed_results(jobs);
}

JobWorkerSettings worker_settings(const Config& config) {
  return {worker_name(), static_cast<int>(config.job_workers),
          absl::Seconds(config.job_lease_seconds)};
}

}  // namespace

absl::StatusOr<std::unique_ptr<JobsAtWork>> JobsAtWork::open(const Config& config,
                                                             MeshEngine& engine,
                                                             StoreUse use) {
  if (!config.has_jobs()) return nullptr;
  const fs::path folder = config.store;
  auto jobs = open_job_store(config.jobs.empty() ? (folder / kFile).string() : config.jobs,
                             job_rules(config));
  if (!jobs.ok()) return jobs.status();
  auto place = std::make_unique<WorkPlace>(**jobs, folder, use);
  if (use == StoreUse::kOwn) {
    // A database that does not answer, or a disk that is full, hinders no server: it looks
    // again.
    const absl::Status found = place->check_store();
    if (reason_of(found) == "WRONG_STORE") return found;
  }
  auto results = ResultStore::open(
      folder / kResults,
      {config.result_bytes, config.disk_reserve_bytes, absl::Hours(config.job_keep_hours)},
      [store = jobs->get(), place = place.get()] { return needed_here(*store, *place); });
  if (!results.ok()) return results.status();
  return std::make_unique<JobsAtWork>(config, engine, *std::move(jobs), std::move(place),
                                      *std::move(results));
}

JobsAtWork::JobsAtWork(const Config& config,
                       MeshEngine& engine,
                       std::unique_ptr<JobStore> jobs,
                       std::unique_ptr<WorkPlace> work_place,
                       std::unique_ptr<ResultStore> stored)
    : store(std::move(jobs)),
      place(std::move(work_place)),
      results(std::move(stored)),
      maker(engine, *store, *results, *place),
      janitor(*store,
              *results,
              absl::Hours(config.job_keep_hours),
              absl::Seconds(config.job_lease_seconds)),
      worker(*store, maker, *place, *results, worker_settings(config)) {}

Reading JobsInServer::up() const {
  return gauge("tetstream_jobs_up",
               "1 unless the jobs' database or the disk of results takes nothing.",
               health.status().ok());
}

absl::StatusOr<std::set<GridKey>> grids_of_jobs(JobStore& jobs) {
  const auto inputs = jobs.inputs();
  if (!inputs.ok()) return inputs.status();
  std::set<GridKey> grids;
  for (const JobInput& input : *inputs) grids.insert({input.space, input.name});
  return grids;
}

}  // namespace tet
