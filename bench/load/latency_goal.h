// What a service is asked to keep, and how sure one can be that it did.
#pragma once

#include <cstdint>
#include <string>

#include <absl/status/statusor.h>
#include <absl/strings/string_view.h>

#include "bench/load/load_clock.h"

namespace tet::load {

/// From the intended start to ...
enum class LatencyKind : std::uint8_t { kHeader, kFirstChunk, kWhole };

/// At least `fraction` of all requests come within `limit`.
struct LatencyGoal {
  LatencyKind kind = LatencyKind::kWhole;
  double fraction = 0.99;  ///< in (0, 1)
  Nanoseconds limit{0};
};

/// "p99=200ms" (the whole mesh), "header-p50=20ms" or "first-chunk-p99.9=50ms".
/// Errors: kInvalidArgument, naming the text.
absl::StatusOr<LatencyGoal> parse_goal(absl::string_view text);

/// Writes a goal as parse_goal reads it.
std::string show_goal(const LatencyGoal& goal);

/// "header", "first chunk" or "whole".
const char* name_of(LatencyKind kind) noexcept;

/// Bounds of a proportion.
struct ProportionInterval {
  double low = 0, high = 1;
};

/// Where the true proportion is with 95 % confidence, when `hits` of `trials` independent ones
/// were seen: Wilson's score interval (1927), which also holds for few trials and none hit.
ProportionInterval wilson_interval(std::uint64_t hits, std::uint64_t trials) noexcept;

}  // namespace tet::load
