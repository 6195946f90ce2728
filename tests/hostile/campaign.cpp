#include "tests/hostile/campaign.h"

#include <chrono>
#include <string>

#include <absl/strings/str_format.h>

namespace tet::test {
namespace {

/// How a file may be refused, whatever is in it.
bool is_expected(absl::StatusCode code) {
  return code == absl::StatusCode::kOk || code == absl::StatusCode::kInvalidArgument ||
         code == absl::StatusCode::kFailedPrecondition ||
         code == absl::StatusCode::kResourceExhausted;
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

CampaignResult run_campaign(const Mutator& mutator,
                            CampaignRange range,
                            const Trial& trial,
                            const std::function<void(std::uint64_t, const Mutant&)>& accepted,
                            std::ostream& log) {
  CampaignResult result;
  result.mutants = range.count;
  for (std::uint64_t i = range.first; i < range.first + range.count; ++i) {
    const Mutant mutant = mutator.mutant(i);
    const auto start = std::chrono::steady_clock::now();
    const absl::Status status = trial(mutant);
    const double seconds = seconds_since(start);
    ++result.outcomes[status.code()];
    result.seconds += seconds;
    if (seconds > result.slowest_seconds) {
      result.slowest_seconds = seconds;
      result.slowest = i;
    }
    if (!is_expected(status.code())) {
      ++result.unexpected;
      log << "mutant " << i << ": " << status << "\n  " << mutant.description << '\n';
    }
    if (status.ok() && mutant.changed) accepted(i, mutant);
    if (status.ok() && mutant.changed) ++result.accepted_changed;
    if (mutant.changed) ++result.unlike_seed;
  }
  return result;
}

void print_result(const CampaignResult& result, std::ostream& out) {
  for (const auto& [code, count] : result.outcomes) {
    out << absl::StrFormat(
        "%10d  %s\n", count,
        code == absl::StatusCode::kOk ? "accepted" : absl::StatusCodeToString(code));
  }
  out << absl::StrFormat(
      "%10d  mutants, %d of them changed, and %d of those accepted\n"
      "%10.3f  seconds in trials; slowest %.3f ms (mutant %d)\n",
      result.mutants, result.unlike_seed, result.accepted_changed, result.seconds,
      result.slowest_seconds * 1e3, result.slowest);
}

}  // namespace tet::test
