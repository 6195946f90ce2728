#include "bench/load/run_load.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <stop_token>
#include <thread>
#include <utility>

#include "bench/load/dispatcher.h"
#include "bench/load/free_workers.h"

namespace tet::load {
namespace {

constexpr std::chrono::milliseconds kPoll{50};
/// Answers on their way when Ctrl-C comes may still arrive.
constexpr std::chrono::milliseconds kInterruptedDrain{200};

std::vector<RateStep> with_warm_up(const LoadPlan& plan) {
  std::vector<RateStep> steps = plan.steps;
  if (plan.warm_up_seconds > 0) {
    steps.insert(steps.begin(), {plan.steps.front().per_second, plan.warm_up_seconds});
  }
  return steps;
}

/// One run under way. The members below main's run on the thread that made it.
class Run {
 public:
  Run(const LoadPlan& plan,
      RequestMix& mix,
      RequestSender& sender,
      const Cancellation& interruption)
      : plan_(plan),
        mix_(mix),
        sender_(sender),
        interruption_(interruption),
        profile_(with_warm_up(plan)),
        statistics_(plan.steps.size(), mix.entries().size()),
        // A stream of its own: the arrivals of a seed do not depend on the mix.
        random_(~plan.seed),
        start_(Clock::now()),
        measure_from_(start_ + from_seconds(plan.warm_up_seconds)),
        end_(start_ + from_seconds(profile_.seconds())),
        free_workers_(plan.workers, start_),
        dispatcher_(plan, sender, statistics_, [this](const absl::Status& status) {
          if (plan_.workers > 0) free_workers_.answered(status);
        }) {}

  /// Every request when it is due, until the end or an interruption.
  void offer_all() { plan_.workers > 0 ? offer_for_workers() : offer_arrivals(); }

  /// Waits for what is outstanding, and gives up on the rest.
  void drain() {
    draining_ = true;
    statistics_.end_window(sender_.traffic());
    const Nanoseconds patience =
        interruption_.requested() ? Nanoseconds{kInterruptedDrain} : plan_.drain;
    const TimePoint until = Clock::now() + patience;
    while (!dispatcher_.wait_until_idle(kPoll) && Clock::now() < until) {
      if (interruption_.requested() && patience != kInterruptedDrain) break;
    }
    dispatcher_.give_up();
  }

  LoadMoment moment() {
    const TimePoint now = Clock::now();
    const double seconds = std::max(to_seconds(now - start_), 0.0);
    LoadMoment moment;
    moment.phase = draining_             ? LoadMoment::Phase::kDraining
                   : now < measure_from_ ? LoadMoment::Phase::kWarmUp
                                         : LoadMoment::Phase::kMeasuring;
    moment.seconds = seconds;
    moment.total_seconds = profile_.seconds();
    if (plan_.workers == 0) {
      moment.rate_per_second = profile_.steps()[profile_.step_at(seconds)].per_second;
    }
    moment.outstanding = dispatcher_.outstanding();
    moment.queued = dispatcher_.queued();
    moment.traffic = sender_.traffic();
    moment.total = statistics_.total();
    moment.recent = statistics_.take_recent();
    return moment;
  }

  LoadResult result() const {
    LoadResult result{plan_, statistics_.total(),  {},
                      {},    statistics_.window(), interruption_.requested()};
    for (std::size_t i = 0; i < plan_.steps.size(); ++i) {
      result.steps.push_back(statistics_.of_step(i));
    }
    for (std::size_t i = 0; i < mix_.entries().size(); ++i) {
      result.entries.push_back(statistics_.of_entry(i));
    }
    return result;
  }

 private:
  void offer_arrivals() {
    Arrivals arrivals(profile_, plan_.process, plan_.seed, plan_.burst);
    while (const std::optional<Arrival> arrival = arrivals.next()) {
      const TimePoint due = start_ + from_seconds(arrival->seconds);
      if (!wait_until(due)) return;
      offer(due, arrival->step);
    }
    wait_until(end_);
  }

  void offer_for_workers() {
    while (wait_until(Clock::now()) && Clock::now() < end_) {
      const auto due = free_workers_.take(std::min(Clock::now() + kPoll, end_));
      if (!due) continue;
      if (wait_until(std::min(*due, end_)) && *due < end_) {
        offer(*due, profile_.step_at(to_seconds(*due - start_)));
      }
    }
  }

  /// `step` is one of the profile, which may begin with the warm-up.
  void offer(TimePoint due, std::size_t step) {
    RequestMix::Drawn drawn = mix_.draw(random_);
    LoadRequest request;
    request.intended = due;
    if (plan_.timeout) request.give_up = due + *plan_.timeout;
    request.entry = drawn.entry;
    request.kind = mix_.entries()[drawn.entry].kind;
    request.skip_cache = mix_.entries()[drawn.entry].skip_cache;
    const std::size_t warm_up_steps = profile_.steps().size() - plan_.steps.size();
    request.measured = step >= warm_up_steps;
    request.step = request.measured ? step - warm_up_steps : 0;
    request.message = std::move(drawn.message);
    dispatcher_.offer(std::move(request));
  }

  /// Sleeps, and begins the measured window on time. False when interrupted.
  bool wait_until(TimePoint time) {
    for (;;) {
      const TimePoint now = Clock::now();
      if (!measuring_ && now >= measure_from_) {
        measuring_ = true;
        statistics_.begin_window(sender_.traffic());
      }
      if (interruption_.requested()) return false;
      if (now >= time) return true;
      const TimePoint mark = measuring_ ? time : std::min(time, measure_from_);
      std::this_thread::sleep_until(std::min(mark, now + kPoll));
    }
  }

  const LoadPlan& plan_;
  RequestMix& mix_;
  RequestSender& sender_;
  const Cancellation& interruption_;
  const RateProfile profile_;
  LoadStatistics statistics_;
  std::mt19937_64 random_;
  const TimePoint start_, measure_from_, end_;
  bool measuring_ = false;
  std::atomic<bool> draining_{false};
  FreeWorkers free_workers_;
  Dispatcher dispatcher_;
};

/// Shows a run to `watch` until it is stopped, and once more then.
void watch_run(const std::stop_token& stop, Run& run, const LoadWatch& watch) {
  std::mutex mutex;
  std::condition_variable_any never;
  while (!stop.stop_requested()) {
    std::unique_lock lock(mutex);
    never.wait_for(lock, stop, watch.interval, [] { return false; });
    watch.see(run.moment());
  }
}

}  // namespace

LoadResult run_load(const LoadPlan& plan,
                    RequestMix& mix,
                    RequestSender& sender,
                    const Cancellation& interruption,
                    const LoadWatch& watch) {
  Run run(plan, mix, sender, interruption);
  std::jthread watcher;
  if (watch.see) {
    watcher = std::jthread([&](const std::stop_token& stop) { watch_run(stop, run, watch); });
  }
  run.offer_all();
  run.drain();
  return run.result();
}

}  // namespace tet::load
