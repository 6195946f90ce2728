#include "bench/load/latency_goal.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <absl/strings/str_split.h>
#include <absl/strings/strip.h>

#include "bench/load/units.h"

namespace tet::load {
namespace {

struct Prefix {
  absl::string_view text;
  LatencyKind kind;
};
constexpr Prefix kPrefixes[] = {{"header-", LatencyKind::kHeader},
                                {"first-chunk-", LatencyKind::kFirstChunk}};

absl::Status not_a_goal(absl::string_view text) {
  return absl::InvalidArgumentError(absl::StrCat(
      "\"", text,
      "\" is not a target: give p99=200ms, header-p50=20ms or first-chunk-p99=50ms"));
}

}  // namespace

absl::StatusOr<LatencyGoal> parse_goal(absl::string_view text) {
  const std::pair<absl::string_view, absl::string_view> sides =
      absl::StrSplit(text, absl::MaxSplits('=', 1));
  absl::string_view quantile = sides.first;
  LatencyGoal goal;
  for (const Prefix& prefix : kPrefixes) {
    if (absl::ConsumePrefix(&quantile, prefix.text)) goal.kind = prefix.kind;
  }
  double percent = 0;
  if (!absl::ConsumePrefix(&quantile, "p") || !absl::SimpleAtod(quantile, &percent) ||
      !(percent > 0 && percent < 100)) {
    return not_a_goal(text);
  }
  goal.fraction = percent / 100;
  const absl::StatusOr<Nanoseconds> limit = parse_time(sides.second);
  if (!limit.ok() || limit->count() <= 0) return not_a_goal(text);
  goal.limit = *limit;
  return goal;
}

std::string show_goal(const LatencyGoal& goal) {
  std::string prefix;
  for (const Prefix& known : kPrefixes) {
    if (known.kind == goal.kind) prefix = std::string(known.text);
  }
  return absl::StrFormat("%sp%g=%gms", prefix, goal.fraction * 100, to_ms(goal.limit));
}

const char* name_of(LatencyKind kind) noexcept {
  switch (kind) {
    case LatencyKind::kHeader:
      return "header";
    case LatencyKind::kFirstChunk:
      return "first chunk";
    case LatencyKind::kWhole:
      return "whole";
  }
  return "";
}

ProportionInterval wilson_interval(std::uint64_t hits, std::uint64_t trials) noexcept {
  if (trials == 0) return {};
  constexpr double kZ = 1.959964;  // 97.5 % of the normal distribution lie below
  const double n = static_cast<double>(trials), p = static_cast<double>(hits) / n;
  const double centre = p + kZ * kZ / (2 * n);
  const double half = kZ * std::sqrt(p * (1 - p) / n + kZ * kZ / (4 * n * n));
  const double scale = 1 + kZ * kZ / n;
  return {std::max((centre - half) / scale, 0.0), std::min((centre + half) / scale, 1.0)};
}

}  // namespace tet::load
