// Stopping long work early: a flag that anyone may raise, and a deadline.
#pragma once

#include <atomic>
#include <chrono>
#include <optional>

#include <absl/status/status.h>

namespace tet {

/// Raised once, never lowered. Long stages poll it between bricks.
///
/// Thread safety: every member may be called from any thread at any time; `cancel` is also safe
/// in a signal handler.
class Cancellation {
 public:
  using Clock = std::chrono::system_clock;

  Cancellation() = default;
  explicit Cancellation(Clock::time_point deadline) : deadline_(deadline) {}

  void cancel() noexcept { cancelled_.store(true, std::memory_order_relaxed); }

  /// True once cancelled or past the deadline.
  bool requested() const noexcept {
    return cancelled_.load(std::memory_order_relaxed) || deadline_passed();
  }
  /// The end of time where there is none.
  Clock::time_point deadline() const noexcept {
    return deadline_.value_or(Clock::time_point::max());
  }
  bool deadline_passed() const noexcept { return deadline_ && Clock::now() >= *deadline_; }

 private:
  std::atomic<bool> cancelled_{false};
  std::optional<Clock::time_point> deadline_;
};

/// OK, or why the work has to stop: kDeadlineExceeded, kCancelled.
absl::Status check_cancelled(const Cancellation& cancellation);

}  // namespace tet
