#include "bench/load/arrivals.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace tet::load {
namespace {

std::vector<Arrival> all_of(Arrivals arrivals) {
  std::vector<Arrival> all;
  while (const auto arrival = arrivals.next()) all.push_back(*arrival);
  return all;
}

std::vector<Arrival> arrivals_of(const std::vector<RateStep>& steps,
                                 ArrivalProcess process,
                                 std::uint64_t seed = 1) {
  return all_of(Arrivals(RateProfile(steps), process, seed));
}

const std::vector<RateStep> kThousandASecond{{1000, 20}};

TEST(RateProfile, InvertsTheExpectedCount) {
  const RateProfile profile({{10, 2}, {40, 1}});
  EXPECT_DOUBLE_EQ(profile.seconds(), 3);
  EXPECT_DOUBLE_EQ(profile.expected_requests(), 60);
  EXPECT_DOUBLE_EQ(profile.time_of(0), 0);
  EXPECT_DOUBLE_EQ(profile.time_of(10), 1);
  EXPECT_DOUBLE_EQ(profile.time_of(20), 2);
  EXPECT_DOUBLE_EQ(profile.time_of(40), 2.5);
  EXPECT_DOUBLE_EQ(profile.time_of(100), 4);
  EXPECT_EQ(profile.step_at(1.99), 0u);
  EXPECT_EQ(profile.step_at(2), 1u);
  EXPECT_EQ(profile.step_at(5), 1u);
}

TEST(Arrivals, AreEvenlySpacedWhenConstant) {
  const std::vector<Arrival> all = arrivals_of({{50, 2}}, ArrivalProcess::kConstant);
  ASSERT_EQ(all.size(), 100u);
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_NEAR(all[i].seconds, static_cast<double>(i) / 50, 1e-12);
  }
}

TEST(Arrivals, ComeInBurstsAtTheSameRateOfRequests) {
  const RateProfile profile({{50, 2}});
  for (const auto process : {ArrivalProcess::kConstant, ArrivalProcess::kPoisson}) {
    const std::vector<Arrival> all = all_of(Arrivals(profile, process, 1, 10));
    ASSERT_FALSE(all.empty());
    EXPECT_EQ(all.size() % 10, 0);
    for (std::size_t i = 0; i < all.size(); ++i) {
      EXPECT_EQ(all[i].seconds, all[i - i % 10].seconds);
    }
  }
  const std::vector<Arrival> even = all_of(Arrivals(profile, ArrivalProcess::kConstant, 1, 10));
  EXPECT_EQ(even.size(), 100u);
  EXPECT_NEAR(even[10].seconds, 0.2, 1e-12);
}

TEST(Arrivals, HaveAPoissonProcessesMeanAndVariance) {
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
    const std::vector<Arrival> all =
        arrivals_of(kThousandASecond, ArrivalProcess::kPoisson, seed);
    // 20000 expected, and so a standard deviation of 141: four of them.
    EXPECT_NEAR(static_cast<double>(all.size()), 20000, 566) << "seed " << seed;
    double sum = 0, squares = 0;
    for (std::size_t i = 1; i < all.size(); ++i) {
      const double gap = all[i].seconds - all[i - 1].seconds;
      ASSERT_GE(gap, 0);
      sum += gap;
      squares += gap * gap;
    }
    const double count = static_cast<double>(all.size() - 1);
    const double mean = sum / count, variance = squares / count - mean * mean;
    EXPECT_NEAR(mean, 1e-3, 0.03e-3) << "seed " << seed;
    // An exponential gap's deviation is its mean.
    EXPECT_NEAR(std::sqrt(variance), 1e-3, 0.05e-3) << "seed " << seed;
  }
}

TEST(Arrivals, CountAsPoissonInEveryWindow) {
  // Counts in windows of 10 ms have mean and variance 10.
  std::vector<int> windows(2000);
  for (const Arrival& arrival : arrivals_of(kThousandASecond, ArrivalProcess::kPoisson)) {
    ++windows[static_cast<std::size_t>(arrival.seconds * 100)];
  }
  double sum = 0, squares = 0;
  for (const int count : windows) {
    sum += count;
    squares += count * count;
  }
  const double mean = sum / 2000, variance = squares / 2000 - mean * mean;
  EXPECT_NEAR(mean, 10, 0.3);
  EXPECT_NEAR(variance, 10, 1.5);
}

TEST(Arrivals, FollowTheStepsOfTheirProfile) {
  for (const ArrivalProcess process : {ArrivalProcess::kConstant, ArrivalProcess::kPoisson}) {
    std::vector<std::size_t> counts(3);
    const std::vector<RateStep> steps{{1000, 4}, {5000, 2}, {2000, 3}};
    for (const Arrival& arrival : arrivals_of(steps, process)) {
      const double seconds = arrival.seconds;
      EXPECT_EQ(arrival.step, seconds < 4 ? 0u : seconds < 6 ? 1u : 2u);
      ++counts[arrival.step];
    }
    EXPECT_NEAR(static_cast<double>(counts[0]), 4000, 260);  // four deviations
    EXPECT_NEAR(static_cast<double>(counts[1]), 10000, 400);
    EXPECT_NEAR(static_cast<double>(counts[2]), 6000, 310);
  }
}

TEST(Arrivals, AreTheSameForTheSameSeedAlone) {
  const auto times_of = [](std::uint64_t seed) {
    std::vector<double> times;
    for (const Arrival& arrival : arrivals_of({{100, 5}}, ArrivalProcess::kPoisson, seed)) {
      times.push_back(arrival.seconds);
    }
    return times;
  };
  EXPECT_TRUE(times_of(5) == times_of(5));
  EXPECT_FALSE(times_of(5) == times_of(6));
}

TEST(UniformNumber, IsInTheHalfOpenInterval) {
  std::mt19937_64 random(3);
  double sum = 0;
  for (int i = 0; i < 100000; ++i) {
    const double number = uniform_number(random);
    ASSERT_GE(number, 0);
    ASSERT_LT(number, 1);
    sum += number;
  }
  EXPECT_NEAR(sum / 100000, 0.5, 0.005);
}

}  // namespace
}  // namespace tet::load
