#include "bench/load/find_rate.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "bench/load/units.h"

namespace tet::load {
namespace {

class Search {
 public:
  Search(const SearchPlan& plan, const RunTrial& run_trial)
      : plan_(plan), run_trial_(run_trial) {}

  SearchResult run() {
    bracket();
    while (!interrupted_ && good_) {
      bisect();
      if (interrupted_ || holds_by_majority(*good_)) break;
      // One lucky trial had put it here.
      failed(*good_);
      good_.reset();
      fall(*bad_ / 2);
    }
    return result();
  }

 private:
  /// The trials of one rate.
  struct Votes {
    int held = 0, not_held = 0;
    std::uint64_t requests = 0, missed = 0;
    Verdict last_failure = Verdict::kInterrupted;
  };

  /// Runs one more trial at a rate; true when it held.
  bool vote(double rate) {
    Votes& votes = votes_[rate];
    const Trial trial = run_trial_(rate, votes.held + votes.not_held);
    trials_.push_back(trial);
    if (trial.verdict == Verdict::kInterrupted) {
      interrupted_ = true;
      return false;
    }
    votes.requests += trial.requests;
    votes.missed += trial.missed;
    const bool held = trial.verdict == Verdict::kHeld;
    ++(held ? votes.held : votes.not_held);
    if (!held) votes.last_failure = trial.verdict;
    return held;
  }

  bool holds_by_majority(double rate) {
    const int majority = plan_.trials / 2 + 1;
    const Votes& votes = votes_[rate];
    while (!interrupted_ && votes.held < majority && votes.not_held < majority) vote(rate);
    return votes.held >= majority;
  }

  void failed(double rate) { bad_ = rate; }

  void bracket() {
    double rate = plan_.start_per_second;
    if (!vote(rate)) {
      if (interrupted_) return;
      failed(rate);
      return fall(rate / 2);
    }
    for (good_ = rate; !bad_ && !interrupted_ && rate < kMaxPerSecond;) {
      rate *= 2;
      if (vote(rate)) {
        good_ = rate;
      } else if (!interrupted_) {
        failed(rate);
      }
    }
  }

  /// Halves until a trial holds.
  void fall(double rate) {
    for (; !interrupted_ && rate >= plan_.min_per_second; rate /= 2) {
      if (vote(rate)) {
        good_ = rate;
        return;
      }
      if (!interrupted_) failed(rate);
    }
  }

  void bisect() {
    while (!interrupted_ && bad_ && *bad_ > *good_ * (1 + plan_.precision)) {
      const double middle = std::sqrt(*good_ * *bad_);
      const bool holds = holds_by_majority(middle);
      if (interrupted_) return;
      (holds ? good_ : bad_) = middle;
    }
  }

  SearchResult result() {
    SearchResult result;
    result.per_second = good_;
    result.failed_per_second = bad_;
    if (bad_) result.limited_by = votes_[*bad_].last_failure;
    result.interrupted = interrupted_;
    if (good_) {
      const Votes& votes = votes_[*good_];
      result.trials = votes.held + votes.not_held;
      result.held = votes.held;
      result.requests = votes.requests;
      result.missed = votes.missed;
      result.missed_share = wilson_interval(votes.missed, votes.requests);
    }
    result.all = std::move(trials_);
    return result;
  }

  const SearchPlan& plan_;
  const RunTrial& run_trial_;
  std::map<double, Votes> votes_;
  std::vector<Trial> trials_;
  std::optional<double> good_, bad_;
  bool interrupted_ = false;
};

}  // namespace

SearchResult find_rate(const SearchPlan& plan, const RunTrial& run_trial) {
  return Search(plan, run_trial).run();
}

}  // namespace tet::load
