// The highest rate of requests at which a service keeps its goals.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "bench/load/latency_goal.h"
#include "bench/load/verdict.h"

namespace tet::load {

/// One run at one rate.
struct Trial {
  double per_second = 0;
  Verdict verdict = Verdict::kInterrupted;
  std::uint64_t requests = 0;  ///< offered
  std::uint64_t missed = 0;    ///< of the goal that most missed; see Tally::missed
};

/// `repetition` counts the trials of a rate from 0, so that each has other arrivals.
using RunTrial = std::function<Trial(double per_second, int repetition)>;

struct SearchPlan {
  double start_per_second = 1;
  double min_per_second = 0.01;  ///< below this it gives up
  int trials = 3;                ///< of which the majority decides; odd
  double precision = 0.05;  ///< the answer and the lowest rate that failed differ by this part
};

struct SearchResult {
  /// The highest rate that held in most of its trials; nothing if none did.
  std::optional<double> per_second;
  /// The lowest rate above it that did not hold, and why.
  std::optional<double> failed_per_second;
  Verdict limited_by = Verdict::kInterrupted;
  bool interrupted = false;
  /// Over all trials at the answer: requests, those that missed, and where the true share of
  /// misses is with 95 % confidence if requests were independent of each other.
  int trials = 0, held = 0;
  std::uint64_t requests = 0, missed = 0;
  ProportionInterval missed_share;

  std::vector<Trial> all;  ///< in the order they were run
};

/// Doubles or halves the rate, one trial each, until one holds and twice that does not; then
/// bisects in between, each rate decided by the majority of its trials; and last makes sure
/// that the answer itself has the majority.
SearchResult find_rate(const SearchPlan& plan, const RunTrial& run_trial);

}  // namespace tet::load
