#include "server/jobs/work/clock_watch.h"

#include <chrono>

#include <absl/time/time.h>
#include <gtest/gtest.h>

namespace tet {
namespace {

using namespace std::chrono_literals;

const ClockWatch::Steady::time_point kStart(100h);
const absl::Time kNow = absl::FromUnixSeconds(1'800'000'000);

/// Looks at a store's clock that runs as ours does, but for what a test says.
class ClockWatchTest : public testing::Test {
 protected:
  ClockWatch::Finding look(ClockWatch::Steady::duration after,
                           absl::Duration store_ahead,
                           ClockWatch::Steady::duration took = 0s) {
    const absl::Time here = kNow + absl::FromChrono(after);
    return watch_.compare({here + store_ahead, here + absl::FromChrono(took), kStart + after,
                           kStart + after + took});
  }

  ClockWatch watch_;
};

TEST_F(ClockWatchTest, FindsNothingWhereClocksAgree) {
  for (const auto after : {0s, 1s, 1000s}) {
    const auto found = look(after, absl::Seconds(2));
    EXPECT_EQ(found.ahead, absl::Seconds(-2));
    EXPECT_FALSE(found.differs);
    EXPECT_FALSE(found.step);
  }
}

TEST_F(ClockWatchTest, FindsAClockThatIsDaysOffHoweverLateTheAnswer) {
  EXPECT_TRUE(look(0s, absl::Hours(48)).differs);
  EXPECT_TRUE(look(10s, absl::Hours(48), 1h).differs);
  EXPECT_FALSE(look(10h, absl::Seconds(1)).differs);
}

TEST_F(ClockWatchTest, FindsAStepEitherWay) {
  look(0s, absl::ZeroDuration());
  EXPECT_EQ(look(1s, absl::Seconds(60)).step, absl::Seconds(60));
  EXPECT_EQ(look(2s, absl::ZeroDuration()).step, absl::Seconds(-60));
  EXPECT_FALSE(look(3s, absl::ZeroDuration()).step);
}

TEST_F(ClockWatchTest, TakesNoPauseOfOursForAStepOrADifference) {
  look(0s, absl::ZeroDuration());
  // Put aside for a minute between the store's reading of its clock and ours of ours.
  const auto paused = look(1s, absl::ZeroDuration(), 60s);
  EXPECT_FALSE(paused.differs);
  EXPECT_FALSE(paused.step);
  const auto after = look(70s, absl::ZeroDuration());
  EXPECT_FALSE(after.differs);
  EXPECT_FALSE(after.step);
}

TEST_F(ClockWatchTest, FindsAStepThatNoPauseExplains) {
  look(0s, absl::ZeroDuration());
  EXPECT_TRUE(look(1s, absl::Hours(1), 60s).step);
}

}  // namespace
}  // namespace tet
