#include "bench/load/run_load.h"

#include <atomic>
#include <vector>

#include <gtest/gtest.h>

#include "bench/load/search_load.h"
#include "tests/bench/load/stand_in.h"

namespace tet::load {
namespace {

using test::StandIn;
using namespace std::chrono_literals;

/// Evenly spaced, without warm-up.
LoadPlan even(double per_second, double seconds) {
  LoadPlan plan;
  plan.steps = {{per_second, seconds}};
  plan.process = ArrivalProcess::kConstant;
  plan.warm_up_seconds = 0;
  return plan;
}

LoadPlan back_to_back(std::size_t workers, double seconds) {
  LoadPlan plan = even(1, seconds);
  plan.workers = workers;
  return plan;
}

LoadResult run(const LoadPlan& plan, RequestSender& sender) {
  RequestMix mix = test::mix_of_one();
  const Cancellation never;
  return run_load(plan, mix, sender, never, {});
}

Nanoseconds whole(const LoadResult& result, double fraction) {
  return result.total.latency(LatencyKind::kWhole).quantile(fraction);
}

void expect_all_accounted_for(const Tally& tally) {
  EXPECT_EQ(tally.offered, tally.done + tally.failed + tally.unfinished + tally.dropped);
  EXPECT_EQ(tally.latency(LatencyKind::kWhole).count(), tally.done + tally.unfinished);
}

TEST(RunLoad, SendsWhatIsDueAndMeasuresIt) {
  StandIn service({.service_time = 1ms});
  const LoadResult result = run(even(200, 0.2), service);
  EXPECT_EQ(result.total.offered, 40u);
  EXPECT_EQ(result.total.done, 40u);
  expect_all_accounted_for(result.total);
  EXPECT_GE(whole(result, 0.01), 1ms);
  EXPECT_NEAR(result.window.seconds, 0.2, 0.1);
  EXPECT_LE(result.window.received.tets, 400u);
  EXPECT_FALSE(result.interrupted);
}

// The point of an open loop: a stall shows in the percentiles as long as it was, although
// hardly a request was sent while it lasted.
TEST(RunLoad, CountsAStallForEveryRequestThatFellDueInIt) {
  StandIn service({.service_time = 100us, .stall_after = 200ms, .stall = 300ms});
  LoadPlan plan = even(500, 0.7);
  plan.max_outstanding = 4;
  const LoadResult result = run(plan, service);
  EXPECT_EQ(result.total.offered, 350u);
  EXPECT_EQ(result.total.done, 350u);
  // 150 of 350 requests fell due in the stall and waited for 0 to 300 ms: a request in a
  // hundred for at least 300 - 7 ms.
  EXPECT_GT(whole(result, 0.99), 280ms);
  EXPECT_GT(whole(result, 0.75), 80ms);
  EXPECT_GT(result.total.queued, 100u);
}

TEST(RunLoad, ShowsWhatAClosedLoopHides) {
  StandIn service({.service_time = 1ms, .stall_after = 200ms, .stall = 300ms});
  const LoadResult result = run(back_to_back(1, 0.7), service);
  // One request of a few hundred met the stall, and no percentile shows it.
  EXPECT_GT(result.total.done, 120u);
  EXPECT_LT(whole(result, 0.99), 100ms);
  EXPECT_GT(result.total.latency(LatencyKind::kWhole).max(), 280ms);
}

TEST(RunLoad, KeepsItsWorkersBusyAndNoMoreThanThose) {
  StandIn service({.service_time = 5ms});
  std::vector<std::size_t> outstanding;
  RequestMix mix = test::mix_of_one();
  const Cancellation never;
  const LoadWatch watch{5ms, [&](const LoadMoment& moment) {
                          if (moment.phase != LoadMoment::Phase::kDraining)
                            outstanding.push_back(moment.outstanding);
                        }};
  const LoadResult result = run_load(back_to_back(3, 0.3), mix, service, never, watch);
  expect_all_accounted_for(result.total);
  EXPECT_LE(result.total.done, 63u);  // 0.3 s at 5 ms each, and those under way
  EXPECT_GE(result.total.done, 30u);
  for (const std::size_t count : outstanding) EXPECT_LE(count, 3u);
  // Each waits for the two before it.
  EXPECT_GE(whole(result, 0.5), 10ms);
  EXPECT_LT(whole(result, 0.5), 20ms);
}

TEST(RunLoad, LetsWorkersRestAfterAFailure) {
  StandIn service({.max_waiting = 0});
  const LoadResult result = run(back_to_back(2, 0.35), service);
  EXPECT_EQ(result.total.done, 0u);
  EXPECT_LE(result.total.failed, 8u);  // four times 100 ms for either
  EXPECT_GE(result.total.failed, 4u);
}

TEST(RunLoad, DropsAndCountsWhatIsOverTheQueue) {
  StandIn service({.service_time = 50ms});
  LoadPlan plan = even(400, 0.2);
  plan.max_outstanding = 2;
  plan.max_queued = 3;
  const LoadResult result = run(plan, service);
  EXPECT_EQ(result.total.offered, 80u);
  EXPECT_GT(result.total.dropped, 60u);
  EXPECT_LE(service.sent(), 20u);
  expect_all_accounted_for(result.total);
}

TEST(RunLoad, GivesUpAfterTheDrainAndSaysHowLongItHadWaited) {
  StandIn service({.service_time = 10s});
  LoadPlan plan = even(100, 0.1);
  plan.drain = 50ms;
  const LoadResult result = run(plan, service);
  EXPECT_EQ(result.total.done, 0u);
  EXPECT_EQ(result.total.unfinished, 10u);
  expect_all_accounted_for(result.total);
  EXPECT_GE(whole(result, 1), 145ms);
  EXPECT_EQ(result.total.missed({LatencyKind::kWhole, 0.5, 10s}), 10u);
}

TEST(RunLoad, BooksRefusalsByTheirCode) {
  StandIn service({.service_time = 20ms, .max_waiting = 2});
  const LoadResult result = run(even(200, 0.2), service);
  expect_all_accounted_for(result.total);
  EXPECT_GT(result.total.errors.at(absl::StatusCode::kResourceExhausted), 10u);
  EXPECT_EQ(result.total.error_messages.at(absl::StatusCode::kResourceExhausted), "too many");
}

TEST(RunLoad, LeavesTheWarmUpOut) {
  // All of the stall is in the warm-up.
  StandIn service({.service_time = 100us, .stall_after = 0ms, .stall = 100ms});
  LoadPlan plan = even(200, 0.2);
  plan.warm_up_seconds = 0.2;
  const LoadResult result = run(plan, service);
  EXPECT_EQ(service.sent(), 80u);
  EXPECT_EQ(result.total.offered, 40u);
  EXPECT_LT(whole(result, 0.9), 50ms);
}

TEST(RunLoad, TellsStepsApart) {
  StandIn service({.service_time = 100us});
  LoadPlan plan = even(100, 0.1);
  plan.steps.push_back({300, 0.1});
  plan.warm_up_seconds = 0.05;
  const LoadResult result = run(plan, service);
  ASSERT_EQ(result.steps.size(), 2u);
  EXPECT_EQ(result.steps[0].offered, 10u);
  EXPECT_EQ(result.steps[1].offered, 30u);
  EXPECT_EQ(result.total.offered, 40u);
}

TEST(RunLoad, EndsSoonWhenInterruptedWithWhatItMeasured) {
  StandIn service({.service_time = 1ms});
  RequestMix mix = test::mix_of_one();
  Cancellation interruption;
  std::jthread stopper([&] {
    std::this_thread::sleep_for(150ms);
    interruption.cancel();
  });
  const TimePoint start = Clock::now();
  const LoadResult result = run_load(even(100, 60), mix, service, interruption, {});
  EXPECT_LT(Clock::now() - start, 1500ms);
  EXPECT_TRUE(result.interrupted);
  EXPECT_GT(result.total.done, 5u);
  EXPECT_LT(result.total.offered, 100u);
  expect_all_accounted_for(result.total);
}

// 5 ms each, one after the other: at most 200 a second, whatever the target.
TEST(SearchLoad, FindsAKnownCapacity) {
  StandIn service({.service_time = 5ms});
  RequestMix mix = test::mix_of_one();
  const Cancellation never;
  const std::vector<LatencyGoal> goals{{LatencyKind::kWhole, 0.9, 50ms}};
  const SearchWatch unseen{[](double) { return LoadWatch{}; }, [](const Trial&) {}};
  SearchPlan search;
  search.start_per_second = 0;
  search.precision = 0.2;
  search.trials = 1;
  const auto found = search_load(search, {even(1, 0.5), goals}, mix, service, never, unseen);
  ASSERT_TRUE(found.ok()) << found.status();
  ASSERT_TRUE(found->search.per_second.has_value());
  // In half a second a surplus of a fifth piles up to the limit.
  EXPECT_GT(*found->search.per_second, 120);
  EXPECT_LT(*found->search.per_second, 260);
  EXPECT_TRUE(found->best.has_value());
}

TEST(SearchLoad, SaysWhatEveryRequestSaysWhenNoneSucceeds) {
  StandIn service({.max_waiting = 0});
  RequestMix mix = test::mix_of_one();
  Cancellation never;
  const std::vector<LatencyGoal> goals{{LatencyKind::kWhole, 0.9, 50ms}};
  const SearchWatch unseen{[](double) { return LoadWatch{}; }, [](const Trial&) {}};
  const auto found =
      search_load({.start_per_second = 0}, {even(1, 0.2), goals}, mix, service, never, unseen);
  EXPECT_TRUE(absl::IsResourceExhausted(found.status())) << found.status();
}

}  // namespace
}  // namespace tet::load
