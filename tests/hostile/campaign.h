// What becomes of many mutants.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <ostream>
#include <string>
#include <vector>

#include <absl/status/status.h>

#include "tests/hostile/mutator.h"

namespace tet::test {

/// What mutants are put through.
struct Trial {
  std::function<absl::Status(const Mutant&)> run;  ///< ok when it was accepted
  /// The processor time that those have used who read mutants, seconds: what else the machine
  /// does changes little of it.
  std::function<double()> used;
};

/// What this process has used.
double processor_seconds();

/// What takes as long beside other trials may be slow, or they are. So may what ends with
/// kDeadlineExceeded, kUnavailable or kAborted: no answer came in time.
inline constexpr double kSlowSeconds = 1;

/// Counts and the slowest of a campaign.
struct CampaignResult {
  std::map<absl::StatusCode, std::uint64_t> outcomes;
  std::uint64_t mutants = 0;
  std::uint64_t unlike_seed = 0;       ///< mutants that differ from their seed at all
  std::uint64_t accepted_changed = 0;  ///< those of them that were accepted
  double seconds = 0;                  ///< of processors, in the trials
  double slowest_seconds = 0;
  std::uint64_t slowest = 0;        ///< the mutant that took it
  std::vector<std::uint64_t> slow;  ///< mutants that took longer than kSlowSeconds, or too long
  std::uint64_t unexpected = 0;     ///< neither accepted nor refused as hostile files are
  std::uint64_t unanswered = 0;     ///< those of them that had no answer in time

  void add(const CampaignResult& other);
};

/// Puts mutant `index` through `trial`; tells an unexpected outcome on `log`.
CampaignResult run_trial(std::uint64_t index,
                         const Mutant& mutant,
                         const Trial& trial,
                         std::ostream& log);

struct CampaignRange {
  std::uint64_t first = 0, count = 0;
};

/// Puts mutants through `trial` one after the other, as `run_trial` does.
/// `accepted` is called with each mutant that was changed and yet accepted.
CampaignResult run_campaign(const Mutator& mutator,
                            CampaignRange range,
                            const Trial& trial,
                            const std::function<void(std::uint64_t, const Mutant&)>& accepted,
                            std::ostream& log);

void print_result(const CampaignResult& result, std::ostream& out);

}  // namespace tet::test
