#include "tests/hostile/campaign.h"

#include <ctime>
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

/// What a machine that is busy with other things may make of any file.
bool is_unanswered(absl::StatusCode code) {
  return code == absl::StatusCode::kDeadlineExceeded ||
         code == absl::StatusCode::kUnavailable || code == absl::StatusCode::kAborted;
}

}  // namespace

double processor_seconds() {
  timespec time{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

void CampaignResult::add(const CampaignResult& other) {
  for (const auto& [code, count] : other.outcomes) outcomes[code] += count;
  mutants += other.mutants;
  unlike_seed += other.unlike_seed;
  accepted_changed += other.accepted_changed;
  unexpected += other.unexpected;
  unanswered += other.unanswered;
  seconds += other.seconds;
  slow.insert(slow.end(), other.slow.begin(), other.slow.end());
  if (other.slowest_seconds <= slowest_seconds) return;
  slowest_seconds = other.slowest_seconds;
  slowest = other.slowest;
}

CampaignResult run_trial(std::uint64_t index,
                         const Mutant& mutant,
                         const Trial& trial,
                         std::ostream& log) {
  const double before = trial.used();
  const absl::Status status = trial.run(mutant);
  CampaignResult result;
  result.seconds = result.slowest_seconds = trial.used() - before;
  result.slowest = index;
  result.unanswered = is_unanswered(status.code()) ? 1 : 0;
  if (result.seconds > kSlowSeconds || result.unanswered > 0) result.slow.push_back(index);
  result.mutants = 1;
  result.outcomes[status.code()] = 1;
  result.unlike_seed = mutant.changed ? 1 : 0;
  result.accepted_changed = mutant.changed && status.ok() ? 1 : 0;
  result.unexpected = is_expected(status.code()) ? 0 : 1;
  if (result.unexpected > 0) {
    log << "mutant " << index << ": " << status << "\n  " << mutant.description << '\n';
  }
  return result;
}

CampaignResult run_campaign(const Mutator& mutator,
                            CampaignRange range,
                            const Trial& trial,
                            const std::function<void(std::uint64_t, const Mutant&)>& accepted,
                            std::ostream& log) {
  CampaignResult result;
  for (std::uint64_t i = range.first; i < range.first + range.count; ++i) {
    const Mutant mutant = mutator.mutant(i);
    const CampaignResult one = run_trial(i, mutant, trial, log);
    if (one.accepted_changed > 0) accepted(i, mutant);
    result.add(one);
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
      "%10.3f  seconds of processors in trials; slowest %.3f ms (mutant %d)\n",
      result.mutants, result.unlike_seed, result.accepted_changed, result.seconds,
      result.slowest_seconds * 1e3, result.slowest);
}

}  // namespace tet::test
