#include "core/base/on_cancel.h"

#include <chrono>
#include <future>
#include <latch>
#include <memory>
#include <optional>
#include <poll.h>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/cancel.h"

namespace tet {
namespace {

bool is_readable(int descriptor) {
  pollfd polled{descriptor, POLLIN, 0};
  return ::poll(&polled, 1, 0) == 1;
}

TEST(CancellationTest, ItsDescriptorIsReadableFromTheCancellationOn) {
  Cancellation cancellation;
  EXPECT_FALSE(is_readable(cancellation.descriptor()));
  cancellation.cancel();
  EXPECT_TRUE(is_readable(cancellation.descriptor()));
}

TEST(CancellationTest, ADescriptorThatIsAskedForAfterwardsIsReadableAtOnce) {
  Cancellation cancellation;
  cancellation.cancel();
  EXPECT_TRUE(is_readable(cancellation.descriptor()));
}

TEST(CancellationTest, ADescriptorThatIsAskedForMeanwhileIsReadableInTheEnd) {
  for (int i = 0; i < 1000; ++i) {
    Cancellation cancellation;
    std::latch both(2);
    std::jthread other([&] {
      both.arrive_and_wait();
      cancellation.cancel();
    });
    both.arrive_and_wait();
    const int descriptor = cancellation.descriptor();
    other.join();
    ASSERT_TRUE(is_readable(descriptor));
  }
}

TEST(CancellationTest, StaysRequestedOnceALookHasFoundItSo) {
  bool is_abandoned = true;
  const Cancellation cancellation(Cancellation::Clock::time_point::max(),
                                  [&] { return is_abandoned; });
  EXPECT_TRUE(cancellation.requested());
  is_abandoned = false;
  EXPECT_TRUE(cancellation.requested());
  EXPECT_EQ(check_cancelled(cancellation).code(), absl::StatusCode::kCancelled);
}

TEST(CancellationTest, StaysUnrequestedThroughLooksThatFindNothing) {
  const Cancellation cancellation(Cancellation::Clock::time_point::max(), [] { return false; });
  EXPECT_FALSE(cancellation.requested());
  EXPECT_FALSE(cancellation.requested());
  EXPECT_TRUE(check_cancelled(cancellation).ok());
}

TEST(OnCancelTest, CallsWhenTheCancellationIsRaised) {
  Cancellation cancellation;
  std::promise<void> called;
  const OnCancel on_cancel(cancellation, [&] { called.set_value(); });
  cancellation.cancel();
  called.get_future().wait();
}

TEST(OnCancelTest, CallsWhenItWasRaisedBefore) {
  Cancellation cancellation;
  cancellation.cancel();
  std::promise<void> called;
  const OnCancel on_cancel(cancellation, [&] { called.set_value(); });
  called.get_future().wait();
}

TEST(OnCancelTest, CallsWhenTheDeadlinePasses) {
  const Cancellation cancellation(Cancellation::Clock::now() + std::chrono::milliseconds(20));
  std::promise<void> called;
  const OnCancel on_cancel(cancellation, [&] { called.set_value(); });
  called.get_future().wait();
  EXPECT_TRUE(cancellation.deadline_passed());
}

TEST(OnCancelTest, CallsEveryOneOfMany) {
  Cancellation cancellation;
  constexpr int kMany = 100;
  std::latch called(kMany);
  std::vector<std::unique_ptr<OnCancel>> all;
  for (int i = 0; i < kMany; ++i) {
    all.push_back(std::make_unique<OnCancel>(cancellation, [&] { called.count_down(); }));
  }
  cancellation.cancel();
  called.wait();
}

TEST(OnCancelTest, DoesNotCallAfterItsEnd) {
  Cancellation cancellation;
  bool called = false;
  {
    const OnCancel on_cancel(cancellation, [&] { called = true; });
  }
  cancellation.cancel();
  // The one thread that calls has come to this one, so it has passed the other by.
  std::promise<void> later;
  const OnCancel on_later(cancellation, [&] { later.set_value(); });
  later.get_future().wait();
  EXPECT_FALSE(called);
}

TEST(OnCancelTest, ItsEndWaitsForTheActionThatRuns) {
  Cancellation cancellation;
  std::promise<void> begun;
  std::promise<void> may_end;
  bool ended = false;
  auto on_cancel = std::make_unique<OnCancel>(cancellation, [&] {
    begun.set_value();
    may_end.get_future().wait();
    ended = true;
  });
  cancellation.cancel();
  begun.get_future().wait();
  std::jthread opener([&] { may_end.set_value(); });
  on_cancel.reset();
  EXPECT_TRUE(ended);
}

TEST(OnCancelTest, AnActionMayEndItsOwn) {
  Cancellation cancellation;
  std::promise<void> ended;
  std::optional<OnCancel> on_cancel;
  std::promise<void> made;
  on_cancel.emplace(cancellation, [&] {
    made.get_future().wait();
    on_cancel.reset();
    ended.set_value();
  });
  made.set_value();
  cancellation.cancel();
  ended.get_future().wait();
}

TEST(OnCancelTest, WhatAnActionThrowsEndsWithIt) {
  Cancellation cancellation;
  const OnCancel throws(cancellation, [] { throw std::runtime_error("an action's own"); });
  std::promise<void> called;
  const OnCancel on_cancel(cancellation, [&] { called.set_value(); });
  cancellation.cancel();
  called.get_future().wait();
}

}  // namespace
}  // namespace tet
