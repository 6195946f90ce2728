// Whether a run kept its goals, and if not, who was in the way.
#pragma once

#include <span>
#include <string>

#include "bench/load/latency_goal.h"
#include "bench/load/run_load.h"

namespace tet::load {

enum class Verdict : std::uint8_t {
  kHeld,         ///< every goal
  kMissed,       ///< the service was too slow
  kRefused,      ///< the service said that it has no room (RESOURCE_EXHAUSTED, UNAVAILABLE)
  kFailed,       ///< requests failed otherwise
  kGenerator,    ///< this program could not send on time or had no processor left
  kInterrupted,  ///< not known
};

/// "held", "missed", "refused", "failed", "generator" or "interrupted".
const char* name_of(Verdict verdict) noexcept;

/// Signs that this program, or the machine under it, was too slow to measure the service.
struct GeneratorState {
  Nanoseconds late_p99{0};  ///< from a request's intended start until it was sent
  double cores_used = 0;    ///< processor seconds a second
  double cores = 0;         ///< that this process may use
  /// It was late by more than a tenth of `matters`, or had less than a tenth of its processors
  /// left.
  bool was_bottleneck(Nanoseconds matters) const noexcept;
};
GeneratorState generator_state(const LoadResult& result);

Verdict judge(const LoadResult& result, std::span<const LatencyGoal> goals);

/// What a reader must know before believing the figures; one sentence each.
std::vector<std::string> warnings_of(const LoadResult& result,
                                     std::span<const LatencyGoal> goals);

}  // namespace tet::load
