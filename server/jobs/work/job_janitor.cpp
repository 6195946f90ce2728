#include "server/jobs/work/job_janitor.h"

#include <chrono>

#include <absl/time/clock.h>

#include "server/ops/logging.h"

namespace tet {

namespace {

constexpr std::chrono::milliseconds kOften{500};
constexpr std::chrono::minutes kSeldom{10};

}  // namespace

JobJanitor::JobJanitor(JobStore& jobs,
                       ResultStore& results,
                       absl::Duration keep,
                       absl::Duration lease)
    : jobs_(jobs),
      results_(results),
      keep_(keep),
      lease_(lease),
      often_(kOften, [this] { look_after_jobs(); }),
      seldom_(kSeldom, [this] { tidy_up(); }) {}

void JobJanitor::look_after_jobs() {
  const auto expired = jobs_.expire();
  tell("jobs_expired", expired);
  const bool in_time = absl::Now() >= rescue_from_;
  const auto rescued = in_time ? jobs_.rescue() : absl::StatusOr<std::int64_t>(0);
  tell("shards_rescued", rescued);
  if (!expired.ok() || !rescued.ok()) rescue_from_ = absl::Now() + lease_;
}

/// A store that fails is told of once.
void JobJanitor::tell(const char* event, const absl::StatusOr<std::int64_t>& count) {
  const bool failed_before = failing_.exchange(!count.ok());
  nlohmann::ordered_json fields;
  if (!count.ok()) {
    if (failed_before) return;
    fields["message"] = std::string(count.status().message());
    log_event(spdlog::level::warn, event, fields);
  } else if (*count > 0) {
    fields["count"] = *count;
    log_event(spdlog::level::info, event, fields);
  }
}

void JobJanitor::tidy_up() {
  tell("jobs_purged", jobs_.purge(absl::Now() - keep_));
  results_.sweep();
}

}  // namespace tet
