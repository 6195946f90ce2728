// What a plan looks to cost, and what it costs, in a thread of its own.
#pragma once

#include <algorithm>
#include <chrono>
#include <string>

#include "core/base/cancel.h"
#include "core/base/own_threads.h"
#include "core/base/thread_time.h"
#include "core/plan/make/plan_mesh.h"
#include "core/plan/plan_price.h"
#include "tests/core/plan/cost_cases.h"

namespace tet::test {

/// Milliseconds of a processor: what else runs on the machine changes little.
struct PlanCost {
  double price = 0;    ///< what it looks to take
  double taken = 0;    ///< what it took
  double pricing = 0;  ///< what it took to find the price
  /// The most between two looks at whether it is cancelled, its start and its end included.
  double longest_gap = 0;
  std::string refusal = {};
};

/// Remembers the longest time between looks.
class LookGaps {
 public:
  void look() noexcept {
    const std::chrono::nanoseconds now = thread_time();
    longest_ = std::max(longest_, now - last_);
    last_ = now;
  }
  std::chrono::nanoseconds longest() const noexcept { return longest_; }

 private:
  std::chrono::nanoseconds last_ = thread_time(), longest_{0};
};

inline PlanCost cost_of(const CostCase& one) {
  const auto milliseconds = [](std::chrono::nanoseconds time) {
    return std::chrono::duration<double, std::milli>(time).count();
  };
  PlanCost cost;
  run_with_own_threads(1, [&] {
    const auto start = thread_time();
    const double bricks = estimate_bricks_to_plan(one.shape, one.request);
    const auto priced = thread_time();
    LookGaps gaps;
    const Cancellation looked_at(Cancellation::Clock::time_point::max(), [&gaps] {
      gaps.look();
      return false;
    });
    const auto plan = plan_mesh({.shape = one.shape, .request = one.request}, looked_at);
    gaps.look();
    cost = {bricks * milliseconds(kBrickTime), milliseconds(thread_time() - priced),
            milliseconds(priced - start), milliseconds(gaps.longest()),
            std::string(plan.status().message())};
  });
  return cost;
}

}  // namespace tet::test
