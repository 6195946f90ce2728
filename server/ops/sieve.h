// Events that strangers can cause, few enough for a log.
#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <optional>
#include <utility>

namespace tet {

/// Lets one event through a second, and counts the others. Thread-safe.
class Sieve {
 public:
  using Clock = std::chrono::steady_clock;

  /// How many were left out before this one; nothing if this one is left out, too.
  std::optional<std::int64_t> pass(Clock::time_point now = Clock::now()) {
    const std::lock_guard lock(mutex_);
    if (now < next_) {
      ++left_out_;
      return std::nullopt;
    }
    next_ = now + std::chrono::seconds(1);
    return std::exchange(left_out_, 0);
  }

 private:
  std::mutex mutex_;
  Clock::time_point next_;
  std::int64_t left_out_ = 0;
};

}  // namespace tet
