// The callers of a closed loop: each asks again when it was answered.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <queue>
#include <vector>

#include <absl/status/status.h>

#include "bench/load/load_clock.h"

namespace tet::load {

/// When each idle worker asks next. Thread safety: any thread may call any member.
class FreeWorkers {
 public:
  /// How long a worker rests after a failure: a refusal must not become a busy loop.
  static constexpr std::chrono::milliseconds kRest{100};

  /// All of them are free now.
  FreeWorkers(std::size_t count, TimePoint now) {
    for (std::size_t i = 0; i < count; ++i) due_.push(now);
  }

  /// A worker was answered.
  void answered(const absl::Status& status) {
    const std::lock_guard lock(mutex_);
    due_.push(Clock::now() + (status.ok() ? Nanoseconds{0} : Nanoseconds{kRest}));
    changed_.notify_one();
  }

  /// When the next free worker asks; nothing if none is free by `until`.
  std::optional<TimePoint> take(TimePoint until) {
    std::unique_lock lock(mutex_);
    if (!changed_.wait_until(lock, until, [this] { return !due_.empty(); })) {
      return std::nullopt;
    }
    const TimePoint due = due_.top();
    due_.pop();
    return due;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::priority_queue<TimePoint, std::vector<TimePoint>, std::greater<>> due_;
};

}  // namespace tet::load
