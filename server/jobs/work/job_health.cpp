#include "server/jobs/work/job_health.h"

#include <chrono>
#include <string>

#include "proto/convert/status.h"
#include "server/ops/logging.h"

namespace tet {

namespace {

constexpr std::chrono::seconds kBeat{1};
// The disk of an idle server is to rest.
constexpr std::chrono::seconds kBetweenLooks{10};

}  // namespace

JobHealth::JobHealth(JobStore& jobs, WorkPlace& place)
    : jobs_(jobs), place_(place), heartbeat_(kBeat, [this] {
        if (is_due()) look();
      }) {
  look();
}

absl::Status JobHealth::status() const {
  const std::lock_guard lock(mutex_);
  return status_;
}

bool JobHealth::is_due() const {
  const std::lock_guard lock(mutex_);
  return !status_.ok() || std::chrono::steady_clock::now() - looked_ >= kBetweenLooks;
}

void JobHealth::look() {
  const absl::Status jobs = jobs_.probe();
  learn(jobs.ok() ? place_.check() : jobs);
}

void JobHealth::learn(const absl::Status& found) {
  const std::lock_guard lock(mutex_);
  looked_ = std::chrono::steady_clock::now();
  if (status_.ok() && !found.ok()) {
    log_event(spdlog::level::err, "jobs_down",
              {{"reason", reason_of(found)}, {"message", std::string(found.message())}});
  } else if (!status_.ok() && found.ok()) {
    log_event(spdlog::level::info, "jobs_up");
  }
  status_ = found;
}

}  // namespace tet
