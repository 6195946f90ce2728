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

/// Clocks that differ by more are told of, and a store's clock that jumps by more has stepped.
constexpr absl::Duration kFewSeconds = absl::Seconds(5);

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
  const auto store_now = jobs_.ask_time();
  if (store_now.ok()) {
    compare(*store_now);
    return true;
  }
  tell("store_time", store_now.status());
  hold(absl::ToChronoNanoseconds(lease_));
  return false;
}

void JobJanitor::compare(absl::Time store_now) {
  const absl::Duration ahead = absl::Now() - store_now;
  clock_ahead_ = absl::ToDoubleSeconds(ahead);
  if (const bool differs = absl::AbsDuration(ahead) > kFewSeconds; differs != differs_) {
    differs_ = differs;
    log_event(differs ? spdlog::level::err : spdlog::level::info,
              differs ? "clock_differs" : "clock_agrees",
              {{"ahead_seconds", absl::ToDoubleSeconds(ahead)},
               {"message", "of this host against the jobs' database, whose times hold"}});
  }
  const absl::Duration now_ahead =
      store_now - absl::UnixEpoch() - absl::FromChrono(Clock::now().time_since_epoch());
  const absl::Duration before = std::exchange(store_ahead_, now_ahead);
  if (before == absl::InfiniteDuration()) return;
  if (absl::AbsDuration(now_ahead - before) <= kFewSeconds) return;
  hold(kAfterStep);
  log_event(spdlog::level::err, "store_clock_stepped",
            {{"seconds", absl::ToDoubleSeconds(now_ahead - before)},
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
