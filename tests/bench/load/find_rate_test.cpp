#include "bench/load/find_rate.h"

#include <random>

#include <gtest/gtest.h>

#include "bench/load/arrivals.h"

namespace tet::load {
namespace {

SearchPlan from(double start_per_second) {
  return {.start_per_second = start_per_second, .min_per_second = 0.01};
}

/// Holds up to a capacity, and is `otherwise` above it.
RunTrial service_with(double capacity, Verdict otherwise = Verdict::kMissed) {
  return [=](double rate, int) {
    const bool holds = rate <= capacity;
    return Trial{rate, holds ? Verdict::kHeld : otherwise, 1000, holds ? 2u : 300u};
  };
}

void expect_found(const SearchResult& result, double capacity) {
  ASSERT_TRUE(result.per_second.has_value());
  EXPECT_LE(*result.per_second, capacity);
  EXPECT_GT(*result.failed_per_second, capacity);
  EXPECT_LE(*result.failed_per_second, *result.per_second * 1.05);
}

TEST(FindRate, FindsTheCapacityFromAnyStart) {
  for (const double start : {0.01, 1.0, 73.0, 74.0, 500.0, 20000.0}) {
    const SearchResult result = find_rate(from(start), service_with(73.5));
    expect_found(result, 73.5);
    EXPECT_LE(result.all.size(), 50u) << "start " << start;
  }
}

TEST(FindRate, DecidesOnItsAnswerByTheMajorityAndSaysOnHowMuch) {
  const SearchResult result = find_rate(from(10), service_with(73.5));
  EXPECT_GE(result.trials, 2);
  EXPECT_EQ(result.held, result.trials);
  EXPECT_EQ(result.requests, 1000u * static_cast<unsigned>(result.trials));
  EXPECT_EQ(result.missed, 2u * static_cast<unsigned>(result.trials));
  EXPECT_LT(result.missed_share.low, 0.002);
  EXPECT_GT(result.missed_share.high, 0.002);
  EXPECT_LT(result.missed_share.high, 0.006);
}

TEST(FindRate, TellsWhatStoodInTheWay) {
  for (const Verdict verdict : {Verdict::kMissed, Verdict::kRefused, Verdict::kGenerator}) {
    EXPECT_EQ(find_rate(from(10), service_with(73.5, verdict)).limited_by, verdict);
  }
}

TEST(FindRate, DoesNotBelieveOneLuckyTrial) {
  const RunTrial lucky = [](double rate, int repetition) {
    const bool holds = rate <= 50 || (rate == 80 && repetition == 0);
    return Trial{rate, holds ? Verdict::kHeld : Verdict::kMissed, 100, 0};
  };
  const SearchResult result = find_rate(from(10), lucky);
  expect_found(result, 50);
}

TEST(FindRate, LivesWithNoiseAroundTheCapacity) {
  std::mt19937_64 random(11);
  // Holds with probability 1/2 at the capacity, nearly never 10 % above it.
  const RunTrial noisy = [&](double rate, int) {
    const double surplus = (rate / 100 - 1) * 10;
    const bool holds = uniform_number(random) > 0.5 + surplus;
    return Trial{rate, holds ? Verdict::kHeld : Verdict::kMissed, 100, 0};
  };
  for (int i = 0; i < 50; ++i) {
    const SearchResult result = find_rate(from(7), noisy);
    ASSERT_TRUE(result.per_second.has_value());
    EXPECT_GT(*result.per_second, 85);
    EXPECT_LT(*result.per_second, 110);
  }
}

TEST(FindRate, GivesUpBelowTheLowestRate) {
  const SearchResult result = find_rate(from(8), service_with(0.001));
  EXPECT_FALSE(result.per_second.has_value());
  EXPECT_EQ(result.limited_by, Verdict::kMissed);
  EXPECT_LT(*result.failed_per_second, 0.02);
}

TEST(FindRate, EndsWhenInterruptedWithWhatItKnows) {
  int trials = 0;
  const RunTrial interrupted = [&](double rate, int) {
    return Trial{rate, ++trials < 4 ? Verdict::kHeld : Verdict::kInterrupted, 100, 0};
  };
  const SearchResult result = find_rate(from(1), interrupted);
  EXPECT_TRUE(result.interrupted);
  EXPECT_EQ(result.per_second, 4);
  EXPECT_FALSE(result.failed_per_second.has_value());
  EXPECT_EQ(result.all.size(), 4u);
}

TEST(FindRate, EndsWhenNothingLimitsIt) {
  const SearchResult result = find_rate(from(1), service_with(1e12));
  EXPECT_GT(*result.per_second, 1e5);
  EXPECT_FALSE(result.failed_per_second.has_value());
}

}  // namespace
}  // namespace tet::load
