// The search for the highest rate, with runs of load as its trials.
#pragma once

#include <functional>
#include <optional>
#include <span>

#include <absl/status/statusor.h>

#include "bench/load/find_rate.h"
#include "bench/load/run_load.h"

namespace tet::load {

struct LoadSearch {
  SearchResult search;
  std::optional<LoadResult> alone;  ///< one worker, where that found the start
  std::optional<LoadResult> best;   ///< a trial at the answer that held
};

/// Shows the runs of a search; both are called between runs, and may return nothing or do
/// nothing.
struct SearchWatch {
  std::function<LoadWatch(double per_second)> begin_trial;
  std::function<void(const Trial&)> end_trial;
};

/// What each trial runs, but for its rate, and what it has to hold.
struct TrialPlan {
  const LoadPlan& load;
  std::span<const LatencyGoal> goals;
};

/// A trial ends when every request that is still unfinished has missed its goal. A start of 0
/// is found by one worker first. Errors: those of its requests when that worker gets no mesh at
/// all.
absl::StatusOr<LoadSearch> search_load(SearchPlan search,
                                       const TrialPlan& trials,
                                       RequestMix& mix,
                                       RequestSender& sender,
                                       const Cancellation& interruption,
                                       const SearchWatch& watch);

/// A run as the search sees it.
Trial trial_of(double per_second, const LoadResult& result, std::span<const LatencyGoal> goals);

}  // namespace tet::load
