#include "server/jobs/work/job_readings.h"

#include <absl/strings/ascii.h>

namespace tet {

namespace {

Reading labelled(Reading reading, const char* label, const std::string& value) {
  reading.labels.emplace_back(label, value);
  return reading;
}

void add_store(const StoreCounts& counts, std::vector<Reading>& readings) {
  constexpr JobState kStates[] = {JobState::kQueued, JobState::kRunning,   JobState::kSucceeded,
                                  JobState::kFailed, JobState::kCancelled, JobState::kExpired};
  for (const JobState state : kStates) {
    const auto found = counts.jobs.find(state);
    const std::int64_t count = found == counts.jobs.end() ? 0 : found->second;
    readings.push_back(labelled(gauge("tetstream_jobs", "Jobs that are kept, by state.", count),
                                "state", absl::AsciiStrToLower(name_of(state))));
  }
  const auto add_shards = [&](const char* state, std::int64_t count) {
    readings.push_back(
        labelled(gauge("tetstream_job_shards", "Shards that are not done, by state.", count),
                 "state", state));
  };
  add_shards("ready", counts.ready_shards);
  add_shards("leased", counts.leased_shards);
  add_shards("backing_off", counts.backing_off);
  add_shards("dead", counts.dead_shards);
  readings.push_back(gauge("tetstream_job_oldest_ready_seconds",
                           "Age of the oldest job that has a shard ready.",
                           absl::ToDoubleSeconds(counts.oldest_ready_age)));
  const auto add_workers = [&](const char* state, std::int64_t count) {
    readings.push_back(labelled(
        gauge("tetstream_workers", "Processes that do jobs and were heard of lately.", count),
        "state", state));
  };
  add_workers("working", counts.workers - counts.troubled_workers);
  add_workers("quarantined", counts.troubled_workers);
  readings.push_back(gauge("tetstream_job_determinism_alarms",
                           "Shards of the jobs that are kept that came with other bytes.",
                           counts.alarms));
}

void add_worker(const JobWorker& worker, std::vector<Reading>& readings) {
  const auto add = [&](const char* outcome, std::int64_t count) {
    readings.push_back(counter("tetstream_worker_shards_total",
                               "Shards that this process had, by how they ended.", count,
                               {{"outcome", outcome}}));
  };
  add("done", worker.done_shards());
  add("failed", worker.failed_shards());
  add("lost", worker.lost_shards());
  add("given_back", worker.given_back_shards() - worker.no_room_shards());
  add("no_room", worker.no_room_shards());
  readings.push_back(gauge("tetstream_worker_fit",
                           "1, or 0 while this process does no jobs since it cannot.",
                           worker.trouble().ok()));
  readings.push_back(counter("tetstream_worker_quarantines_total",
                             "Times that this process had to stop doing jobs.",
                             worker.quarantines()));
}

void add_results(const ResultStats& results, std::vector<Reading>& readings) {
  readings.push_back(
      gauge("tetstream_result_bytes", "Bytes of meshes that jobs made.", results.bytes));
  readings.push_back(
      gauge("tetstream_result_meshes", "Meshes that jobs made.", results.meshes));
  readings.push_back(gauge("tetstream_result_budget_bytes", "The setting result_bytes.",
                           results.budget_bytes));
  readings.push_back(counter("tetstream_result_evictions_total",
                             "Meshes of jobs that had to make room.", results.evicted));
}

}  // namespace

std::vector<Reading> read_jobs(JobStore& jobs,
                               const ResultStore& results,
                               const JobJanitor& janitor,
                               const JobWorker& worker) {
  std::vector<Reading> readings;
  const auto counts = jobs.counts();
  if (counts.ok()) add_store(*counts, readings);
  readings.push_back(
      gauge("tetstream_clock_ahead_seconds",
            "How far this host's clock is ahead of the clock of the jobs' database.",
            janitor.clock_ahead_seconds()));
  add_worker(worker, readings);
  add_results(results.stats(), readings);
  return readings;
}

}  // namespace tet
