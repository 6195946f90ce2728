// A service with known properties, in this process.
#pragma once

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "bench/load/request_mix.h"
#include "bench/load/request_sender.h"

namespace tet::load::test {

/// Serves one request after the other, each for the same time, so that its capacity is known.
/// It ends requests at the moments that its clock says, however late its thread wakes up. With
/// `by_schedule` it takes every request as sent when it was due and waits for nothing, so that
/// all latencies are known to the nanosecond, whatever the machine does meanwhile.
class StandIn final : public RequestSender {
 public:
  struct Behaviour {
    Nanoseconds service_time{std::chrono::milliseconds(1)};
    /// Counted from when the first request was due.
    Nanoseconds stall_after{std::chrono::hours(1)}, stall{0};
    std::size_t stall_with = 0;  ///< it begins with this request, from 1, in place of then
    std::size_t max_waiting = 1000000;  ///< more are refused at once
    bool by_schedule = false;
  };

  /// A request that was served.
  struct Served {
    Nanoseconds latency{};  ///< since it was due
    bool measured = true;
    bool stalled = false;
  };

  explicit StandIn(const Behaviour& behaviour)
      : behaviour_(behaviour), thread_([this] { serve(); }) {}
  ~StandIn() override {
    {
      const std::lock_guard lock(mutex_);
      closing_ = true;
    }
    changed_.notify_all();
    thread_.join();
  }

  void send(const LoadRequest& request, Done done) override {
    const std::lock_guard lock(mutex_);
    last_sent_ = Clock::now();
    const TimePoint arrived = behaviour_.by_schedule ? request.intended : last_sent_;
    if (++sent_ == 1) {
      first_sent_ = last_sent_;
      stall_from_ = request.intended + behaviour_.stall_after;
    }
    if (sent_ == behaviour_.stall_with) stall_from_ = arrived;
    waiting_.push_back({request, std::move(done), arrived, sent_});
    changed_.notify_all();
  }

  void give_up() override {
    const std::lock_guard lock(mutex_);
    given_up_ = sent_;
    changed_.notify_all();
  }

  Traffic traffic() const override {
    const std::lock_guard lock(mutex_);
    return {10 * served_.size(), 100 * served_.size()};
  }

  /// In the order in which they were served.
  std::vector<Served> served() const {
    const std::lock_guard lock(mutex_);
    return served_;
  }

  std::size_t sent() const {
    const std::lock_guard lock(mutex_);
    return sent_;
  }

  /// From the first request that was sent to the last, by the clock.
  Nanoseconds sending() const {
    const std::lock_guard lock(mutex_);
    return last_sent_ - first_sent_;
  }

 private:
  struct Waiting {
    LoadRequest request;
    Done done;
    TimePoint arrived;
    std::size_t number;  ///< from 1
  };

  void serve() {
    for (std::unique_lock lock(mutex_);;) {
      changed_.wait(lock, [this] { return closing_ || !waiting_.empty(); });
      if (waiting_.empty()) return;
      const bool refused = waiting_.size() > behaviour_.max_waiting;
      // The last to come is the one that finds no room.
      Waiting next = std::move(refused ? waiting_.back() : waiting_.front());
      refused ? waiting_.pop_back() : waiting_.pop_front();
      Outcome outcome;
      outcome.sent = next.arrived;
      if (refused) {
        outcome.status = absl::ResourceExhaustedError("too many");
        outcome.ended = next.arrived;
      } else {
        const TimePoint alone = std::max(next.arrived, free_from_) + behaviour_.service_time;
        outcome.ended = after_the_stall(alone);
        const bool cancelled =
            !behaviour_.by_schedule && changed_.wait_until(lock, outcome.ended, [&] {
              return next.number <= given_up_ || closing_;
            });
        if (cancelled) {
          outcome.status = absl::CancelledError("given up");
          outcome.ended = Clock::now();
        } else {
          free_from_ = outcome.ended;
          outcome.header = outcome.first_chunk = outcome.ended;
          served_.push_back({outcome.ended - next.request.intended, next.request.measured,
                             outcome.ended != alone});
        }
      }
      lock.unlock();
      next.done(outcome);
      lock.lock();
    }
  }

  TimePoint after_the_stall(TimePoint finish) const {
    const bool stalls = finish > stall_from_ && finish < stall_from_ + behaviour_.stall;
    return stalls ? stall_from_ + behaviour_.stall : finish;
  }

  const Behaviour behaviour_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Waiting> waiting_;
  TimePoint free_from_{}, stall_from_{}, first_sent_{}, last_sent_{};
  std::size_t sent_ = 0;
  std::vector<Served> served_;
  std::size_t given_up_ = 0;  ///< up to this one
  bool closing_ = false;
  std::thread thread_;
};

/// One kind of request that nobody reads.
inline RequestMix mix_of_one() {
  MixEntry entry;
  entry.label = "nothing";
  return RequestMix({entry});
}

}  // namespace tet::load::test
