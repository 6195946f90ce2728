// What a thread has used of the processors.
#pragma once

#include <atomic>
#include <chrono>
#include <ctime>
#include <pthread.h>

namespace tet {

/// The processor time of the calling thread so far: what else runs on the machine changes
/// nothing.
inline std::chrono::nanoseconds thread_time() noexcept {
  timespec time{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
}

/// The processor time of the thread that makes it, for others to look at. It must not be asked
/// once that thread has ended.
class ThreadClock {
 public:
  ThreadClock() noexcept {
    if (::pthread_getcpuclockid(::pthread_self(), &clock_) != 0) clock_ = CLOCK_MONOTONIC;
  }

  std::chrono::nanoseconds now() const noexcept {
    timespec time{};
    ::clock_gettime(clock_, &time);
    return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
  }

 private:
  clockid_t clock_{};
};

/// So much processor time of the thread that makes it, from then on. Other threads may look at
/// it while that one lives.
class ThreadBudget {
 public:
  using Clock = std::chrono::steady_clock;

  explicit ThreadBudget(std::chrono::nanoseconds most) noexcept
      : end_(clock_.now() + most), next_look_(Clock::now() + most) {}

  bool is_spent() const noexcept {
    const Clock::time_point now = Clock::now();
    if (now < next_look_.load(std::memory_order_relaxed)) return false;
    const std::chrono::nanoseconds left = end_ - clock_.now();
    // A thread uses no more than the time that passes, and that clock takes a system call.
    if (left.count() > 0) next_look_.store(now + left, std::memory_order_relaxed);
    return left.count() <= 0;
  }

 private:
  const ThreadClock clock_;
  const std::chrono::nanoseconds end_;
  mutable std::atomic<Clock::time_point> next_look_;
};

}  // namespace tet
