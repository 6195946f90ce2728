#include "bench/load/run_load.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "bench/load/search_load.h"
#include "tests/bench/load/stand_in.h"
#include "tests/support/eventually.h"

namespace tet::load {
namespace {

using test::StandIn;
using namespace std::chrono_literals;

/// Evenly spaced, without warm-up; what was sent is waited for.
LoadPlan even(double per_second, double seconds) {
  LoadPlan plan;
  plan.steps = {{per_second, seconds}};
  plan.process = ArrivalProcess::kConstant;
  plan.warm_up_seconds = 0;
  plan.drain = tet::test::kGenerousEnd;
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

/// Has `run` make a run of `seconds`, or ten or a hundred times as long where it says that too
/// little was offered: a thread that stands still for all of a short run offers nothing.
void run_until_enough(double seconds, const std::function<bool(double seconds)>& run) {
  EXPECT_TRUE(run(seconds) || run(10 * seconds) || run(100 * seconds));
}

Nanoseconds whole(const LoadResult& result, double fraction) {
  return result.total.latency(LatencyKind::kWhole).quantile(fraction);
}

/// Latencies that the service knows, in order.
std::vector<Nanoseconds> latencies_of(const StandIn& service) {
  std::vector<Nanoseconds> latencies;
  for (const StandIn::Served& served : service.served()) {
    if (served.measured) latencies.push_back(served.latency);
  }
  std::sort(latencies.begin(), latencies.end());
  return latencies;
}

/// A run's latencies are those that the service knows.
void expect_measured_as_served(const LoadResult& result, const StandIn& service) {
  const std::vector<Nanoseconds> latencies = latencies_of(service);
  ASSERT_FALSE(latencies.empty());
  const LatencyHistogram measured = result.total.latency(LatencyKind::kWhole);
  EXPECT_EQ(measured.count(), latencies.size());
  EXPECT_EQ(measured.max(), latencies.back());
  for (const double fraction : {0.01, 0.5, 0.75, 0.99}) {
    const auto rank =
        std::llround(std::ceil(fraction * static_cast<double>(latencies.size()) - 1e-9));
    const auto expected = static_cast<double>(
        latencies[static_cast<std::size_t>(std::max(rank, 1LL) - 1)].count());
    EXPECT_GE(static_cast<double>(measured.quantile(fraction).count()), expected);
    EXPECT_LE(static_cast<double>(measured.quantile(fraction).count()),
              expected * (1 + LatencyHistogram::kRelativeError) + 1);
  }
}

void expect_all_accounted_for(const Tally& tally) {
  EXPECT_EQ(tally.offered, tally.done + tally.failed + tally.unfinished + tally.dropped);
  EXPECT_EQ(tally.latency(LatencyKind::kWhole).count(), tally.done + tally.unfinished);
}

TEST(RunLoad, SendsWhatIsDueAndMeasuresIt) {
  StandIn service({.service_time = 1ms});
  const TimePoint start = Clock::now();
  const LoadResult result = run(even(200, 0.2), service);
  const Nanoseconds took = Clock::now() - start;
  EXPECT_EQ(result.total.offered, 40u);
  EXPECT_EQ(result.total.done, 40u);
  expect_all_accounted_for(result.total);
  EXPECT_GE(whole(result, 0.01), 1ms);
  expect_measured_as_served(result, service);
  EXPECT_GE(result.window.seconds, to_seconds(service.sending()));  // 0.195 s, if on time
  EXPECT_LE(result.window.seconds, to_seconds(took));
  EXPECT_LE(result.window.received.tets, 400u);
  EXPECT_FALSE(result.interrupted);
}

// The point of an open loop: a stall shows in the percentiles as long as it was, although
// hardly a request was sent while it lasted.
TEST(RunLoad, CountsAStallForEveryRequestThatFellDueInIt) {
  StandIn service(
      {.service_time = 100us, .stall_after = 200ms, .stall = 300ms, .by_schedule = true});
  const LoadResult result = run(even(500, 0.7), service);
  EXPECT_EQ(result.total.offered, 350u);
  EXPECT_EQ(result.total.done, 350u);
  // 150 of 350 requests fell due in the stall and waited for 0 to 300 ms, one more every 2 ms:
  // a request in a hundred for 300 - 7 ms at least, and a quarter for 300 - 175.
  EXPECT_GT(whole(result, 0.99), 290ms);
  EXPECT_GT(whole(result, 0.75), 120ms);
  EXPECT_LT(whole(result, 0.5), 1ms);
  expect_measured_as_served(result, service);
}

TEST(RunLoad, HoldsBackWhatIsOverTheOutstandingAndCountsItsWaitAll) {
  StandIn service({.service_time = 100us, .stall_after = 200ms, .stall = 300ms});
  LoadPlan plan = even(500, 0.7);
  plan.max_outstanding = 4;
  const LoadResult result = run(plan, service);
  EXPECT_EQ(result.total.done, 350u);
  EXPECT_GT(result.total.queued, 100u);
  EXPECT_GT(whole(result, 0.99), 280ms);
  expect_measured_as_served(result, service);
}

TEST(RunLoad, ShowsWhatAClosedLoopHides) {
  run_until_enough(0.7, [](double seconds) {
    StandIn service({.service_time = 1ms, .stall = 300ms, .stall_with = 1});
    const LoadResult result = run(back_to_back(1, seconds), service);
    if (result.total.offered == 0) return false;
    const std::vector<StandIn::Served> served = service.served();
    // One request of all those that were sent met the stall.
    EXPECT_EQ(std::count_if(served.begin(), served.end(),
                            [](const StandIn::Served& request) { return request.stalled; }),
              1);
    EXPECT_GT(result.total.latency(LatencyKind::kWhole).max(), 280ms);
    expect_measured_as_served(result, service);
    return true;
  });
}

TEST(RunLoad, KeepsItsWorkersBusyAndNoMoreThanThose) {
  run_until_enough(0.3, [](double seconds) {
    StandIn service({.service_time = 5ms});
    std::vector<std::size_t> outstanding;
    RequestMix mix = test::mix_of_one();
    const Cancellation never;
    const LoadWatch watch{5ms, [&](const LoadMoment& moment) {
                            if (moment.phase != LoadMoment::Phase::kDraining)
                              outstanding.push_back(moment.outstanding);
                          }};
    const LoadResult result = run_load(back_to_back(3, seconds), mix, service, never, watch);
    if (result.total.offered < 3) return false;
    expect_all_accounted_for(result.total);
    // 5 ms each, and those under way.
    EXPECT_LE(static_cast<double>(result.total.done), seconds / 0.005 + 3);
    EXPECT_GE(result.total.done, 3u);
    for (const std::size_t count : outstanding) EXPECT_LE(count, 3u);
    // The last of the first three waits for the two before it.
    EXPECT_GE(whole(result, 1), 15ms);
    expect_measured_as_served(result, service);
    return true;
  });
}

TEST(RunLoad, LetsWorkersRestAfterAFailure) {
  run_until_enough(0.35, [](double seconds) {
    StandIn service({.max_waiting = 0});
    const LoadResult result = run(back_to_back(2, seconds), service);
    if (result.total.offered < 2) return false;
    EXPECT_EQ(result.total.done, 0u);
    // One for either, and another after each 100 ms.
    EXPECT_LE(static_cast<double>(result.total.failed), 2 * std::ceil(seconds / 0.1));
    EXPECT_GE(result.total.failed, 2u);
    return true;
  });
}

TEST(RunLoad, DropsAndCountsWhatIsOverTheQueue) {
  StandIn service({.service_time = 1h});
  LoadPlan plan = even(400, 0.2);
  plan.max_outstanding = 2;
  plan.max_queued = 3;
  plan.drain = 0ms;
  const LoadResult result = run(plan, service);
  EXPECT_EQ(result.total.offered, 80u);
  EXPECT_EQ(result.total.unfinished, 5u);
  EXPECT_EQ(result.total.dropped, 75u);
  EXPECT_EQ(service.sent(), 2u);
  expect_all_accounted_for(result.total);
}

TEST(RunLoad, GivesUpAfterTheDrainAndSaysHowLongItHadWaited) {
  StandIn service({.service_time = 1h});
  LoadPlan plan = even(100, 0.1);
  plan.drain = 50ms;
  const LoadResult result = run(plan, service);
  EXPECT_EQ(result.total.done, 0u);
  EXPECT_EQ(result.total.unfinished, 10u);
  expect_all_accounted_for(result.total);
  EXPECT_GE(whole(result, 1), 145ms);
  EXPECT_EQ(result.total.missed({LatencyKind::kWhole, 0.5, 1h}), 10u);
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
  StandIn service(
      {.service_time = 100us, .stall_after = 0ms, .stall = 100ms, .by_schedule = true});
  LoadPlan plan = even(200, 0.2);
  plan.warm_up_seconds = 0.2;
  const LoadResult result = run(plan, service);
  EXPECT_EQ(service.sent(), 80u);
  EXPECT_EQ(result.total.offered, 40u);
  EXPECT_EQ(result.total.latency(LatencyKind::kWhole).max(), 100us);
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

/// Passes requests on, and interrupts the run with one of them.
class Interrupts final : public RequestSender {
 public:
  Interrupts(RequestSender& sender, std::size_t at, Cancellation& interruption)
      : sender_(sender), at_(at), interruption_(interruption) {}

  void send(const LoadRequest& request, Done done) override {
    sender_.send(request, std::move(done));
    if (++sent_ == at_) interruption_.cancel();
  }
  void give_up() override { sender_.give_up(); }
  Traffic traffic() const override { return sender_.traffic(); }

 private:
  RequestSender& sender_;
  const std::size_t at_;
  Cancellation& interruption_;
  std::size_t sent_ = 0;
};

TEST(RunLoad, EndsWhenInterruptedWithWhatItMeasured) {
  StandIn service({.service_time = 1ms});
  Cancellation interruption;
  Interrupts sender(service, 6, interruption);
  RequestMix mix = test::mix_of_one();
  const LoadResult result = run_load(even(100, 3600), mix, sender, interruption, {});
  EXPECT_TRUE(result.interrupted);
  EXPECT_EQ(result.total.offered, 6u);
  expect_all_accounted_for(result.total);
}

// 5 ms each, one after the other: at most 200 a second, whatever the target.
TEST(SearchLoad, FindsAKnownCapacity) {
  StandIn service({.service_time = 5ms, .by_schedule = true});
  RequestMix mix = test::mix_of_one();
  const Cancellation never;
  const std::vector<LatencyGoal> goals{{LatencyKind::kWhole, 0.9, 50ms}};
  const SearchWatch unseen{[](double) { return LoadWatch{}; }, [](const Trial&) {}};
  SearchPlan search;
  search.start_per_second = 20;
  search.precision = 0.2;
  search.trials = 1;
  const auto found = search_load(search, {even(1, 0.5), goals}, mix, service, never, unseen);
  ASSERT_TRUE(found.ok()) << found.status();
  ASSERT_TRUE(found->search.per_second.has_value());
  // In half a second a surplus of a fifth piles up to the limit.
  EXPECT_GE(*found->search.per_second, 160);
  EXPECT_LT(*found->search.per_second, 260);
  EXPECT_TRUE(found->best.has_value());
}

TEST(SearchLoad, SaysWhatEveryRequestSaysWhenNoneSucceeds) {
  run_until_enough(0.2, [](double seconds) {
    StandIn service({.max_waiting = 0});
    RequestMix mix = test::mix_of_one();
    const Cancellation never;
    const std::vector<LatencyGoal> goals{{LatencyKind::kWhole, 0.9, 50ms}};
    const SearchWatch unseen{[](double) { return LoadWatch{}; }, [](const Trial&) {}};
    const auto found = search_load({.start_per_second = 0}, {even(1, seconds), goals}, mix,
                                   service, never, unseen);
    // What it says where nothing was offered.
    if (absl::IsDeadlineExceeded(found.status())) return false;
    EXPECT_TRUE(absl::IsResourceExhausted(found.status())) << found.status();
    return true;
  });
}

}  // namespace
}  // namespace tet::load
