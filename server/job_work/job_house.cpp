#include "server/job_work/job_house.h"

#include <chrono>

#include <absl/time/clock.h>

#include "server/logging.h"

namespace tet {

namespace {

constexpr std::chrono::milliseconds kOften{500};
constexpr std::chrono::minutes kSeldom{10};

void log_if_some(const char* event, const absl::StatusOr<std::int64_t>& count) {
  if (count.ok() && *count == 0) return;
  nlohmann::ordered_json fields;
  if (count.ok()) {
    fields["count"] = *count;
  } else {
    fields["message"] = std::string(count.status().message());
  }
  log_event(count.ok() ? spdlog::level::info : spdlog::level::warn, event, fields);
}

}  // namespace

JobHouse::JobHouse(JobStore& jobs, ResultStore& results, absl::Duration keep)
    : jobs_(jobs),
      results_(results),
      keep_(keep),
      often_(kOften, [this] { look_after_jobs(); }),
      seldom_(kSeldom, [this] { tidy_up(); }) {}

void JobHouse::look_after_jobs() {
  log_if_some("shards_rescued", jobs_.rescue());
  log_if_some("jobs_expired", jobs_.expire());
}

void JobHouse::tidy_up() {
  log_if_some("jobs_purged", jobs_.purge(absl::Now() - keep_));
  results_.sweep();
}

}  // namespace tet
