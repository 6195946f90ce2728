#include "bench/load/search_load.h"

#include <algorithm>
#include <map>
#include <utility>

namespace tet::load {
namespace {

/// With fewer requests than this in a trial, its percentiles mean nothing.
constexpr double kMinRequests = 5;

constexpr double kProbeSeconds = 2;

/// One worker for the time of a trial, at most kProbeSeconds.
LoadPlan plan_of_one_worker(LoadPlan plan) {
  plan.workers = 1;
  plan.warm_up_seconds = 0;
  plan.steps = {{1, std::min(kProbeSeconds, plan.steps.front().seconds)}};
  return plan;
}

/// Half the rate that one worker got, so that nobody waits for anybody.
absl::StatusOr<double> start_of(const LoadResult& alone) {
  const Tally& total = alone.total;
  if (alone.interrupted) return absl::CancelledError("stopped before the first trial");
  if (total.done > 0) {
    const LatencyHistogram whole = total.latency(LatencyKind::kWhole);
    return 0.5 / std::max(to_seconds(whole.mean()), 1e-6);
  }
  if (total.errors.empty()) {
    return absl::DeadlineExceededError("not one request was answered within --drain");
  }
  const auto& [code, message] = *total.error_messages.begin();
  return absl::Status(code, message);
}

}  // namespace

Trial trial_of(double per_second,
               const LoadResult& result,
               std::span<const LatencyGoal> goals) {
  // The goal nearest to being missed, or missed by most.
  const auto misses = [&](const LatencyGoal& goal) {
    return static_cast<double>(result.total.missed(goal)) / (1 - goal.fraction);
  };
  const LatencyGoal& worst = *std::ranges::max_element(goals, {}, misses);
  return {per_second, judge(result, goals), result.total.offered, result.total.missed(worst)};
}

absl::StatusOr<LoadSearch> search_load(SearchPlan search,
                                       const TrialPlan& trials,
                                       RequestMix& mix,
                                       RequestSender& sender,
                                       const Cancellation& interruption,
                                       const SearchWatch& watch) {
  const auto& [plan, goals] = trials;
  LoadSearch found;
  const double seconds = plan.steps.front().seconds;
  if (search.start_per_second <= 0) {
    found.alone =
        run_load(plan_of_one_worker(plan), mix, sender, interruption, watch.begin_trial(0));
    const absl::StatusOr<double> start = start_of(*found.alone);
    if (!start.ok()) return start.status();
    search.start_per_second = std::max(*start, kMinRequests / seconds);
  }
  search.min_per_second = std::min(kMinRequests / seconds, search.start_per_second);

  std::map<double, LoadResult> held;
  const auto run_trial = [&, &plan = plan, &goals = goals](double per_second, int repetition) {
    LoadPlan trial_plan = plan;
    trial_plan.steps = {{per_second, seconds}};
    trial_plan.drain = std::ranges::max(goals, {}, &LatencyGoal::limit).limit;
    trial_plan.seed = plan.seed + static_cast<std::uint64_t>(repetition);
    LoadResult result =
        run_load(trial_plan, mix, sender, interruption, watch.begin_trial(per_second));
    const Trial trial = trial_of(per_second, result, goals);
    watch.end_trial(trial);
    if (trial.verdict == Verdict::kHeld) held.insert_or_assign(per_second, std::move(result));
    return trial;
  };
  found.search = find_rate(search, run_trial);
  if (found.search.per_second) {
    if (const auto best = held.find(*found.search.per_second); best != held.end()) {
      found.best = std::move(best->second);
    }
  }
  return found;
}

}  // namespace tet::load
