#include "bench/load/latency_histogram.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "bench/load/arrivals.h"

namespace tet::load {
namespace {

/// Latencies from 1 ns to a quarter of an hour, evenly over the decades.
std::vector<std::int64_t> random_latencies(std::size_t count) {
  std::mt19937_64 random(7);
  std::vector<std::int64_t> latencies(count);
  for (std::int64_t& latency : latencies) {
    latency = std::llround(std::pow(10.0, 12 * uniform_number(random)));
  }
  return latencies;
}

TEST(LatencyHistogram, AnswersNothingWhenEmpty) {
  const LatencyHistogram empty;
  EXPECT_EQ(empty.count(), 0u);
  EXPECT_EQ(empty.quantile(0.99), Nanoseconds{0});
  EXPECT_EQ(empty.max(), Nanoseconds{0});
  EXPECT_EQ(empty.mean(), Nanoseconds{0});
}

TEST(LatencyHistogram, IsExactForShortLatencies) {
  for (std::int64_t ns = 0; ns < 2048; ++ns) {
    LatencyHistogram histogram;
    histogram.add(Nanoseconds(ns));
    histogram.add(Nanoseconds(5000));
    ASSERT_EQ(histogram.quantile(0.5), Nanoseconds(ns));
  }
}

TEST(LatencyHistogram, KeepsItsErrorBoundForEveryQuantileOfRandomLatencies) {
  std::vector<std::int64_t> latencies = random_latencies(10000);
  LatencyHistogram histogram;
  for (const std::int64_t latency : latencies) histogram.add(Nanoseconds(latency));
  std::ranges::sort(latencies);
  for (std::size_t rank = 1; rank <= latencies.size(); ++rank) {
    const double fraction = static_cast<double>(rank) / static_cast<double>(latencies.size());
    const auto exact = static_cast<double>(latencies[rank - 1]);
    const auto told = static_cast<double>(histogram.quantile(fraction - 1e-9).count());
    ASSERT_GE(told, exact);
    ASSERT_LE(told, exact * (1 + LatencyHistogram::kRelativeError));
  }
  EXPECT_EQ(histogram.max(), Nanoseconds(latencies.back()));
}

TEST(LatencyHistogram, KeepsItsErrorBoundAtEveryPowerOfTwo) {
  for (int bit = 1; bit < 62; ++bit) {
    for (const std::int64_t offset : {-1, 0, 1}) {
      const std::int64_t ns = (std::int64_t{1} << bit) + offset;
      LatencyHistogram histogram;
      histogram.add(Nanoseconds(ns));
      histogram.add(Nanoseconds(std::numeric_limits<std::int64_t>::max()));
      const std::int64_t told = histogram.quantile(0.5).count();
      ASSERT_GE(told, ns);
      ASSERT_LE(static_cast<double>(told - ns), static_cast<double>(ns) / 1024);
    }
  }
}

TEST(LatencyHistogram, TakesTheLowestLatencyThatEnoughDoNotExceed) {
  LatencyHistogram histogram;
  for (const int ns : {10, 20, 30, 40}) histogram.add(Nanoseconds(ns));
  EXPECT_EQ(histogram.quantile(0).count(), 10);
  EXPECT_EQ(histogram.quantile(0.25).count(), 10);
  EXPECT_EQ(histogram.quantile(0.26).count(), 20);
  EXPECT_EQ(histogram.quantile(0.99).count(), 40);
  EXPECT_EQ(histogram.quantile(1).count(), 40);
  EXPECT_EQ(histogram.mean().count(), 25);
}

TEST(LatencyHistogram, AddsAnother) {
  LatencyHistogram one, other, both;
  for (const std::int64_t latency : random_latencies(1000)) {
    (latency % 2 == 0 ? one : other).add(Nanoseconds(latency));
    both.add(Nanoseconds(latency));
  }
  one.add(other);
  EXPECT_EQ(one.count(), both.count());
  EXPECT_EQ(one.max(), both.max());
  for (const double fraction : {0.1, 0.5, 0.9, 0.999}) {
    EXPECT_EQ(one.quantile(fraction), both.quantile(fraction));
  }
}

TEST(LatencyHistogram, CountsWhatIsAboveALimit) {
  LatencyHistogram histogram;
  for (int ms = 1; ms <= 100; ++ms) histogram.add(std::chrono::milliseconds(ms));
  EXPECT_EQ(histogram.count_above(std::chrono::milliseconds(100)), 0u);
  EXPECT_EQ(histogram.count_above(std::chrono::milliseconds(90)), 10u);
  EXPECT_EQ(histogram.count_above(Nanoseconds{0}), 100u);
}

TEST(LatencyHistogram, CountsANegativeLatencyAsNone) {
  LatencyHistogram histogram;
  histogram.add(Nanoseconds(-5));
  EXPECT_EQ(histogram.quantile(1), Nanoseconds{0});
}

}  // namespace
}  // namespace tet::load
