#include "bench/load/units.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bench/load/latency_goal.h"

namespace tet::load {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using namespace std::chrono_literals;

TEST(ParseTime, ReadsEveryUnit) {
  EXPECT_EQ(*parse_time("200ms"), 200ms);
  EXPECT_EQ(*parse_time("50us"), 50us);
  EXPECT_EQ(*parse_time("7ns"), 7ns);
  EXPECT_EQ(*parse_time("1.5s"), 1500ms);
  EXPECT_EQ(*parse_time("2m"), 2min);
  EXPECT_EQ(*parse_time("1h"), 1h);
  EXPECT_EQ(*parse_time("3"), 3s);
  EXPECT_EQ(*parse_time("0"), 0s);
}

TEST(ParseTime, RefusesWhatIsNoTimeAndNamesIt) {
  for (const char* text : {"", "ms", "fast", "-1s", "1 day", "nan", "inf", "1e30h"}) {
    const auto time = parse_time(text);
    ASSERT_FALSE(time.ok()) << text;
    EXPECT_THAT(std::string(time.status().message()), HasSubstr(text));
  }
}

TEST(ParseRates, ReadsOneSeveralAndARamp) {
  EXPECT_THAT(*parse_rates("2.5"), ElementsAre(2.5));
  EXPECT_THAT(*parse_rates("5,10,20"), ElementsAre(5, 10, 20));
  EXPECT_THAT(*parse_rates("10:40:4"), ElementsAre(10, 20, 30, 40));
}

TEST(ParseRates, RefusesWhatIsNoRate) {
  for (const char* text :
       {"", "0", "-1", "5,", "5,x", "1:2", "1:2:1", "1:2:99999", "0:5:3", "inf"}) {
    EXPECT_FALSE(parse_rates(text).ok()) << text;
  }
}

TEST(ParseRates, RefusesMoreThanCanBeOffered) {
  EXPECT_THAT(*parse_rates("1e6"), ElementsAre(1e6));
  for (const char* text : {"1000001", "1e9", "1e300", "5,1e9", "1:1e9:3"}) {
    const auto rates = parse_rates(text);
    ASSERT_FALSE(rates.ok()) << text;
    EXPECT_THAT(std::string(rates.status().message()), HasSubstr("is over 1000000 a second"));
  }
}

TEST(Show, TakesThreeDigitsAndAUnit) {
  EXPECT_EQ(show_time(0ns), "0 s");
  EXPECT_EQ(show_time(1234ns), "1.23 us");
  EXPECT_EQ(show_time(12345us), "12.3 ms");
  EXPECT_EQ(show_time(1500ms), "1.5 s");
  EXPECT_EQ(show_time(2h), "7200 s");
  EXPECT_EQ(show_number(12.345), "12.3");
  EXPECT_EQ(show_number(999.7), "1k");
  EXPECT_EQ(show_number(1234567), "1.23M");
  EXPECT_EQ(show_number(5e9), "5G");
}

TEST(ParseGoal, ReadsWhatShowGoalWrites) {
  for (const char* text : {"p99=200ms", "header-p50=20ms", "first-chunk-p99.9=1500ms"}) {
    const auto goal = parse_goal(text);
    ASSERT_TRUE(goal.ok()) << goal.status();
    EXPECT_EQ(show_goal(*goal), text);
  }
  EXPECT_EQ(parse_goal("p99=2s")->limit, 2s);
  EXPECT_EQ(parse_goal("first-chunk-p99=1s")->kind, LatencyKind::kFirstChunk);
  EXPECT_DOUBLE_EQ(parse_goal("p99.9=1s")->fraction, 0.999);
}

TEST(ParseGoal, RefusesWhatIsNoGoal) {
  for (const char* text : {"", "p99", "99=1s", "p0=1s", "p100=1s", "p99=0s", "tail-p99=1s"}) {
    EXPECT_FALSE(parse_goal(text).ok()) << text;
  }
}

TEST(WilsonInterval, IsThePublishedOne) {
  // Newcombe 1998, table I: 81 of 263, 15 of 148, 0 of 20, 1 of 29.
  const auto expect = [](std::uint64_t hits, std::uint64_t trials, double low, double high) {
    const ProportionInterval interval = wilson_interval(hits, trials);
    EXPECT_NEAR(interval.low, low, 5e-5);
    EXPECT_NEAR(interval.high, high, 5e-5);
  };
  expect(81, 263, 0.2553, 0.3662);
  expect(15, 148, 0.0624, 0.1605);
  expect(0, 20, 0.0000, 0.1611);
  expect(1, 29, 0.0061, 0.1718);
}

TEST(WilsonInterval, KnowsNothingWithoutTrials) {
  EXPECT_EQ(wilson_interval(0, 0).low, 0);
  EXPECT_EQ(wilson_interval(0, 0).high, 1);
}

}  // namespace
}  // namespace tet::load
