#include "server/jobs/work/job_janitor.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include <absl/time/clock.h>

#include "server/ops/logging.h"

namespace tet {

namespace {

constexpr std::chrono::milliseconds kOften{500};
constexpr std::chrono::seconds kTick{1};
constexpr std::chrono::minutes kSeldom{10};

/// Nothing ends for so long after the store's clock has stepped: workers extend their leases by
/// the new time, and somebody may set it right.
constexpr std::chrono::minutes kAfterStep{10};

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
      seldom_(kTick, [this] { tidy_up(); }) {}

void JobJanitor::look_after_jobs() {
  if (!look_at_clocks() || Clock::now() < act_from_.load()) return;
  const auto expired = jobs_.expire();
  tell("jobs_expired", expired);
  const auto rescued = jobs_.rescue();
  tell("shards_rescued", rescued);
  if (!expired.ok() || !rescued.ok()) hold(absl::ToChronoNanoseconds(lease_));
}

void JobJanitor::hold(Clock::duration time) {
  act_from_ = std::max(act_from_.load(), Clock::now() + time);
}

/// False if the store did not answer.
bool JobJanitor::look_at_clocks() {
  const Clock::time_point asked = Clock::now();
  const auto store_now = jobs_.ask_time();
  const absl::Time here = absl::Now();
  if (store_now.ok()) {
    tell_clocks(clocks_.compare({*store_now, here, asked, Clock::now()}));
    return true;
  }
  tell("store_time", store_now.status());
  hold(absl::ToChronoNanoseconds(lease_));
  return false;
}

void JobJanitor::tell_clocks(const ClockWatch::Finding& found) {
  clock_ahead_ = absl::ToDoubleSeconds(found.ahead);
  if (found.differs != differs_) {
    differs_ = found.differs;
    log_event(differs_ ? spdlog::level::err : spdlog::level::info,
              differs_ ? "clock_differs" : "clock_agrees",
              {{"ahead_seconds", absl::ToDoubleSeconds(found.ahead)},
               {"message", "of this host against the jobs' database, whose times hold"}});
  }
  if (!found.step) return;
  hold(kAfterStep);
  log_event(spdlog::level::err, "store_clock_stepped",
            {{"seconds", absl::ToDoubleSeconds(*found.step)},
             {"message", "leases, times to live and purges wait for ten minutes"}});
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
  if (Clock::now() < std::max(tidy_from_, act_from_.load())) return;
  const bool is_first = tidy_from_ == Clock::time_point::min();
  tidy_from_ = Clock::now() + kSeldom;
  tell("jobs_purged", jobs_.purge(keep_));
  if (!is_first) results_.sweep();  // opening them did
}

}  // namespace tet
