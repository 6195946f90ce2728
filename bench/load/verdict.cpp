#include "bench/load/verdict.h"

#include <algorithm>
#include <cmath>
#include <sched.h>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "bench/load/units.h"

namespace tet::load {
namespace {

/// Timers and the scheduler cost this much on a healthy machine.
constexpr std::chrono::milliseconds kTolerableLateness{2};

/// A quantile is worth printing when so many requests are beyond it.
constexpr double kMinBeyondQuantile = 5;

double cores_of_this_process() {
  cpu_set_t set;
  CPU_ZERO(&set);
  return sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : 1;
}

std::uint64_t refusals(const Tally& tally) {
  std::uint64_t count = 0;
  for (const auto code :
       {absl::StatusCode::kResourceExhausted, absl::StatusCode::kUnavailable}) {
    if (const auto found = tally.errors.find(code); found != tally.errors.end()) {
      count += found->second;
    }
  }
  return count;
}

/// What the lateness is held against: the tightest goal, else the typical latency.
Nanoseconds time_that_matters(const LoadResult& result, std::span<const LatencyGoal> goals) {
  if (goals.empty()) return result.total.latency(LatencyKind::kFirstChunk).quantile(0.5);
  return std::ranges::min(goals, {}, &LatencyGoal::limit).limit;
}

std::string generator_warning(const GeneratorState& generator) {
  return absl::StrFormat(
      "this program may be the bottleneck: it sent 1 %% of the requests more than %s late and "
      "used %.2f of %.0f cores; run it on a machine of its own, or several of it",
      show_time(generator.late_p99), generator.cores_used, generator.cores);
}

void warn_of_counts(const LoadResult& result, std::vector<std::string>& warnings) {
  const Tally& total = result.total;
  if (total.queued > 0) {
    warnings.push_back(absl::StrFormat(
        "%d requests waited because %d were outstanding; their latency counts the wait "
        "(--max-outstanding)",
        total.queued, result.plan.max_outstanding));
  }
  if (total.dropped > 0) {
    warnings.push_back(absl::StrFormat(
        "%d requests were dropped because %d were waiting already; no latency includes them",
        total.dropped, result.plan.max_queued));
  }
  if (total.unfinished > 0) {
    warnings.push_back(absl::StrFormat(
        "%d requests were given up unfinished; they count with the time until then, so that "
        "percentiles are lower bounds",
        total.unfinished));
  }
  if (total.failed > 0) {
    warnings.push_back(
        absl::StrFormat("%d requests failed; no latency includes them", total.failed));
  }
}

void warn_of_few(const Tally& total,
                 std::span<const LatencyGoal> goals,
                 std::vector<std::string>& warnings) {
  for (const LatencyGoal& goal : goals) {
    const double beyond = (1 - goal.fraction) * static_cast<double>(total.offered);
    if (beyond >= kMinBeyondQuantile) continue;
    warnings.push_back(absl::StrFormat(
        "p%g of %d requests rests on the slowest %.0f; a longer --duration is surer",
        goal.fraction * 100, total.offered, std::max(std::ceil(beyond), 1.0)));
  }
}

}  // namespace

const char* name_of(Verdict verdict) noexcept {
  switch (verdict) {
    case Verdict::kHeld:
      return "held";
    case Verdict::kMissed:
      return "missed";
    case Verdict::kRefused:
      return "refused";
    case Verdict::kFailed:
      return "failed";
    case Verdict::kGenerator:
      return "generator";
    case Verdict::kInterrupted:
      return "interrupted";
  }
  return "";
}

bool GeneratorState::was_bottleneck(Nanoseconds matters) const noexcept {
  return late_p99 > std::max<Nanoseconds>(kTolerableLateness, matters / 10) ||
         cores_used > 0.9 * cores;
}

GeneratorState generator_state(const LoadResult& result) {
  const Window& window = result.window;
  return {.late_p99 = result.total.lateness.quantile(0.99),
          .cores_used = window.seconds > 0 ? window.generator_cpu_seconds / window.seconds : 0,
          .cores = cores_of_this_process()};
}

Verdict judge(const LoadResult& result, std::span<const LatencyGoal> goals) {
  const Tally& total = result.total;
  const auto holds = [&](const LatencyGoal& goal) { return total.holds(goal); };
  if (result.interrupted) return Verdict::kInterrupted;
  if (std::ranges::all_of(goals, holds)) return Verdict::kHeld;
  const std::uint64_t refused = refusals(total);
  const auto broken = std::ranges::find_if_not(goals, holds);
  const auto too_many = (1 - broken->fraction) * static_cast<double>(total.offered);
  if (static_cast<double>(refused) > too_many) return Verdict::kRefused;
  if (static_cast<double>(total.failed) > too_many) return Verdict::kFailed;
  return generator_state(result).was_bottleneck(broken->limit) ? Verdict::kGenerator
                                                               : Verdict::kMissed;
}

std::vector<std::string> warnings_of(const LoadResult& result,
                                     std::span<const LatencyGoal> goals) {
  std::vector<std::string> warnings;
  if (result.interrupted) warnings.emplace_back("it was ended early by a signal");
  warn_of_counts(result, warnings);
  const GeneratorState generator = generator_state(result);
  if (generator.was_bottleneck(time_that_matters(result, goals))) {
    warnings.push_back(generator_warning(generator));
  }
  warn_of_few(result.total, goals, warnings);
  return warnings;
}

}  // namespace tet::load
