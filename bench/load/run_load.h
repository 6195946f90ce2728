// One run of load, from the first request to the last answer.
#pragma once

#include <functional>
#include <vector>

#include "bench/load/load_plan.h"
#include "bench/load/load_statistics.h"
#include "bench/load/request_mix.h"
#include "bench/load/request_sender.h"
#include "core/base/cancel.h"

namespace tet::load {

/// A moment of a run, for whoever watches.
struct LoadMoment {
  enum class Phase : std::uint8_t { kWarmUp, kMeasuring, kDraining };
  Phase phase = Phase::kWarmUp;
  double seconds = 0, total_seconds = 0;  ///< since the start; until arrivals end
  double rate_per_second = 0;             ///< of the step; 0 with workers
  std::size_t outstanding = 0, queued = 0;
  Traffic traffic;
  Tally total;   ///< measured so far
  Tally recent;  ///< since the last moment
};

/// Who watches a run, on a thread of its own so that a slow terminal delays no request.
struct LoadWatch {
  Nanoseconds interval{std::chrono::seconds(1)};
  std::function<void(const LoadMoment&)> see;  ///< may be empty
};

struct LoadResult {
  LoadPlan plan;
  Tally total;
  std::vector<Tally> steps;    ///< of the plan
  std::vector<Tally> entries;  ///< of the mix
  Window window;
  bool interrupted = false;
};

/// Sends the plan's requests when they are due, whatever became of those before, and waits for
/// the answers. Returns within about a second of an interruption.
LoadResult run_load(const LoadPlan& plan,
                    RequestMix& mix,
                    RequestSender& sender,
                    const Cancellation& interruption,
                    const LoadWatch& watch);

}  // namespace tet::load
