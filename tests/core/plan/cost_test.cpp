// What the server takes plans for, before they are made, beside what they are.
#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/core/plan/plan_cost.h"

namespace tet::test {
namespace {

/// The worst request of each kind, by name, with what it costs. Both times are the processor's,
/// and are compared with those of a plain ball of the same run: a slow machine, or one that is
/// busy, makes all of them slower.
class PlanCosts : public testing::Test {
 protected:
  struct Measured {
    PlanCost plain;  ///< of about a hundredth of a second
    std::vector<std::pair<std::string, PlanCost>> others;
  };

  static const Measured& measured() {
    static const Measured once = [] {
      Measured costs;
      cost_of(plain_ball(40));  // whatever is made once, is made
      std::array<PlanCost, 5> plain;
      for (PlanCost& one : plain) one = cost_of(plain_ball(40));
      std::ranges::nth_element(plain, plain.begin() + 2, {}, &PlanCost::taken);
      costs.plain = plain[2];
      for (const CostCase& one : cost_cases(1))
        costs.others.emplace_back(one.name, cost_of(one));
      return costs;
    }();
    return once;
  }
};

TEST_F(PlanCosts, AreWhatPlansLookToCostToWithinAFactor) {
  // What looks dearer than it is waits for a longer turn; what looks cheaper is done twice.
  constexpr double kMostUnder = 4, kMostOver = 8;
  const auto& [plain, others] = measured();
  for (const auto& [name, cost] : others) {
    const double ratio = (cost.taken / cost.price) / (plain.taken / plain.price);
    EXPECT_LT(ratio, kMostUnder) << name << ": " << cost.taken << " ms";
    // What is refused once it is looked at takes less than it would.
    if (!cost.refusal.empty()) continue;
    EXPECT_GT(ratio, 1 / kMostOver) << name << ": " << cost.taken << " ms";
  }
}

TEST_F(PlanCosts, AreNotThoseOfTheirPrice) {
  const auto& [plain, others] = measured();
  for (const auto& [name, cost] : others) {
    EXPECT_LT(cost.pricing, cost.taken / 4 + plain.taken) << name;
  }
}

TEST_F(PlanCosts, AreLittleBetweenLooksAtWhetherTheyAreCancelled) {
  // A tenth of a second where a plain ball takes what it does on the machine of kBrickTime.
  constexpr double kMost = 8;
  const auto& [plain, others] = measured();
  for (const auto& [name, cost] : others) {
    EXPECT_LT(cost.longest_gap, kMost * plain.taken) << name << ", of " << cost.taken << " ms";
  }
}

}  // namespace
}  // namespace tet::test
