// What a run does.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "bench/load/arrivals.h"
#include "bench/load/load_clock.h"

namespace tet::load {

struct LoadPlan {
  /// Open loop: each step of the profile in turn. The warm-up runs at the first step's rate.
  std::vector<RateStep> steps;
  ArrivalProcess process = ArrivalProcess::kPoisson;
  std::size_t burst = 1;  ///< so many arrive at once; the rate is still that of requests
  /// Closed loop when not 0: so many callers who each ask again when they were answered, for
  /// the time of the (only) step.
  std::size_t workers = 0;

  double warm_up_seconds = 3;          ///< before the steps, and not measured
  std::size_t max_outstanding = 256;   ///< sent and not answered; more wait in a queue
  std::size_t max_queued = 10000;      ///< more are dropped
  std::optional<Nanoseconds> timeout;  ///< a request's deadline, from its intended start
  Nanoseconds drain{
      std::chrono::seconds(10)};  ///< how long the last may take before being given up
  std::uint64_t seed = 1;
};

}  // namespace tet::load
