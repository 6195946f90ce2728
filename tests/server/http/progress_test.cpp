#include "server/http/progress.h"

#include <gtest/gtest.h>

namespace tet {
namespace {

using Clock = Progress::Clock;

Clock::time_point second(int number) { return Clock::time_point(std::chrono::seconds(number)); }

TEST(Progress, IsBytesAndNotHowOftenTheyCome) {
  Progress progress;
  progress.begin(second(0));
  for (int i = 1; i < 100; ++i) progress.moved(1, second(i));
  EXPECT_EQ(progress.since(), second(0));
  progress.moved(Progress::kStride - 100, second(100));
  EXPECT_EQ(progress.since(), second(0));
  progress.moved(1, second(101));
  EXPECT_EQ(progress.since(), second(101));
}

TEST(Progress, CountsWhatIsBeyondAStrideForTheNext) {
  Progress progress;
  progress.begin(second(0));
  progress.moved(2 * Progress::kStride - 1, second(1));
  progress.moved(1, second(2));
  EXPECT_EQ(progress.since(), second(2));
}

TEST(Progress, BeginsAnewWhereTheOtherSideIsWaitedForAnew) {
  Progress progress;
  progress.moved(Progress::kStride - 1, second(1));
  progress.begin(second(2));
  progress.moved(1, second(3));
  EXPECT_EQ(progress.since(), second(2));
}

TEST(Progress, OfAnAnswerIsWhatTheOtherSideTakesOfTheSocket) {
  Progress progress;
  progress.begin(second(0));
  // More than the socket says to have room for again until a third of it is taken.
  const std::size_t given = 40 * Progress::kStride;
  progress.gave(given);
  progress.looked(given, second(1));
  EXPECT_EQ(progress.since(), second(0));
  for (int i = 1; i <= 10; ++i) {
    progress.looked(given - static_cast<std::size_t>(i) * Progress::kStride, second(i + 1));
    EXPECT_EQ(progress.since(), second(i + 1));
  }
  EXPECT_TRUE(progress.is_taking());
  progress.looked(0, second(20));
  EXPECT_FALSE(progress.is_taking());
}

TEST(Progress, IsNotFooledByWhatTlsAdds) {
  Progress progress;
  progress.begin(second(0));
  progress.gave(Progress::kStride);
  progress.looked(Progress::kStride + 88, second(1));
  EXPECT_EQ(progress.since(), second(0));
  progress.looked(Progress::kStride + 1, second(2));
  EXPECT_EQ(progress.since(), second(0));
  progress.looked(0, second(3));
  EXPECT_EQ(progress.since(), second(3));
}

}  // namespace
}  // namespace tet
