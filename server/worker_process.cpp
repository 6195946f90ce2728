#include "server/worker_process.h"

#include <chrono>
#include <utility>

#include "server/jobs_in_server.h"
#include "server/ops/guard.h"
#include "server/ops/latest_readings.h"
#include "server/ops/memory.h"
#include "server/ops/metrics_port.h"
#include "server/ops/process_metrics.h"
#include "server/server_readings.h"

namespace tet {

// In the order they are needed; destroyed in the other.
struct WorkerProcess::Parts {
  Parts(Config settings, std::unique_ptr<Access> nobody, std::unique_ptr<GridStore> grids)
      : config(std::move(settings)), access(std::move(nobody)), store(std::move(grids)) {}

  std::vector<Reading> slow_readings() const;
  std::string metrics_text();
  bool finds_work();

  const Config config;
  const std::unique_ptr<Access> access;  // of no calls: there are none
  const std::unique_ptr<GridStore> store;
  Admission admission{AdmissionLimits()};
  CallRegistry calls{*access, admission};
  MeshEngine engine{config, calls, *store};
  std::unique_ptr<JobsAtWork> jobs;
  LatestReadings latest{[this] { return slow_readings(); }};
  std::unique_ptr<MetricsPort> metrics;
  std::int64_t settled_shards = 0;  // when it last looked
  std::chrono::steady_clock::time_point last_work = std::chrono::steady_clock::now();
};

/// What asks a disk or a database, or waits for who does.
std::vector<Reading> WorkerProcess::Parts::slow_readings() const {
  std::vector<Reading> readings = read_server(engine, *store);
  for (Reading& reading : jobs->readings()) readings.push_back(std::move(reading));
  return readings;
}

std::string WorkerProcess::Parts::metrics_text() {
  return calls.metrics().text([this] {
    std::vector<Reading> readings = latest.get();
    for (Reading& reading : calls.clients().readings()) readings.push_back(std::move(reading));
    for (Reading& reading : read_process()) readings.push_back(std::move(reading));
    return readings;
  });
}

/// The store is asked only by a worker that did nothing since it last looked. One that does not
/// answer may have work.
bool WorkerProcess::Parts::finds_work() {
  const JobWorker& worker = jobs->worker;
  const std::int64_t settled =
      worker.done_shards() + worker.failed_shards() + worker.lost_shards();
  if (std::exchange(settled_shards, settled) != settled) return true;
  const auto counts = jobs->store->counts();
  return !counts.ok() || counts->ready_shards + counts->leased_shards + counts->backing_off > 0;
}

absl::StatusOr<std::unique_ptr<WorkerProcess>> WorkerProcess::start(const Config& settings) {
  Config config = settings;
  if (auto divided = divide_memory(config); !divided.ok()) return divided;
  if (config.job_workers == 0) {
    return absl::InvalidArgumentError("a worker needs job_workers of 1 or more");
  }
  auto grids = GridStore::open_beside_server(config.store);
  if (!grids.ok()) return grids.status();
  log_contained_exceptions();
  auto nobody = Access::open("");
  if (!nobody.ok()) return nobody.status();
  auto parts = std::make_unique<Parts>(config, *std::move(nobody), *std::move(grids));
  auto jobs = JobsAtWork::open(parts->config, parts->engine, StoreUse::kBeside);
  if (!jobs.ok()) return jobs.status();
  if (*jobs == nullptr) return absl::InvalidArgumentError("a worker needs jobs, which are off");
  parts->jobs = *std::move(jobs);
  if (!config.metrics_listen.empty()) {
    auto metrics = MetricsPort::open(
        config.metrics_listen,
        {[raw = parts.get()] { return raw->metrics_text(); }, [] { return true; }});
    if (!metrics.ok()) return metrics.status();
    parts->metrics = *std::move(metrics);
  }
  return std::unique_ptr<WorkerProcess>(new WorkerProcess(std::move(parts)));
}

WorkerProcess::WorkerProcess(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}

WorkerProcess::~WorkerProcess() = default;

bool WorkerProcess::is_idle() {
  if (parts_->config.job_idle_seconds == 0) return false;
  const auto now = std::chrono::steady_clock::now();
  if (parts_->finds_work()) parts_->last_work = now;
  return now - parts_->last_work >= std::chrono::seconds(parts_->config.job_idle_seconds);
}

std::string WorkerProcess::metrics_address() const {
  return parts_->metrics == nullptr ? "" : parts_->metrics->address();
}

}  // namespace tet
