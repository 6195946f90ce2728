// When something happened last.
#pragma once

#include <atomic>
#include <chrono>
#include <limits>

namespace tet {

/// Thread-safe.
class LastTime {
 public:
  using Clock = std::chrono::steady_clock;

  /// It happens now.
  void note() noexcept { time_.store(Clock::now().time_since_epoch().count()); }
  /// Whether it has happened at `then` or later.
  bool is_since(Clock::time_point then) const noexcept {
    return time_.load() >= then.time_since_epoch().count();
  }

 private:
  std::atomic<Clock::rep> time_{std::numeric_limits<Clock::rep>::min()};
};

}  // namespace tet
