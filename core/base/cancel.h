// Stopping long work early: a flag that anyone may raise, and a deadline.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <optional>
#include <utility>

#include <absl/status/status.h>

namespace tet {

class WakeEvent;

/// Raised once, never lowered. Long stages look at it between bricks; what waits for something
/// else meanwhile is called back (on_cancel.h) or waits for its descriptor beside the other.
///
/// Thread safety: every member may be called from any thread at any time; `cancel` is also safe
/// in a signal handler.
class Cancellation {
 public:
  using Clock = std::chrono::system_clock;
  /// Whether the work has to stop for another reason: asked by whoever looks, on any thread,
  /// until it has said so once. Must not throw.
  using Stop = std::function<bool()>;

  Cancellation() = default;
  explicit Cancellation(Clock::time_point deadline) : deadline_(deadline) {}
  /// Nobody is called back when `stop` becomes true, and no descriptor shows it.
  Cancellation(Clock::time_point deadline, Stop stop)
      : deadline_(deadline), stop_(std::move(stop)) {}
  ~Cancellation();
  Cancellation(const Cancellation&) = delete;
  Cancellation& operator=(const Cancellation&) = delete;

  void cancel() noexcept;

  /// True once cancelled or past the deadline. From the first look on that finds it so it stays
  /// so, whatever clocks and `Stop` say later: what one stage left out no other may take for
  /// whole.
  bool requested() const noexcept {
    return cancelled_.load(std::memory_order_relaxed) || deadline_passed() || stop_asked();
  }
  /// The end of time where there is none.
  Clock::time_point deadline() const noexcept {
    return deadline_.value_or(Clock::time_point::max());
  }
  /// Stays true, too, though a clock be set back.
  bool deadline_passed() const noexcept {
    return stays(deadline_passed_, [this] { return deadline_ && Clock::now() >= *deadline_; });
  }

  /// For poll(2): readable from `cancel` on. A deadline does not show there. Negative when the
  /// process has no more descriptors; whoever polls then looks at `requested` now and then.
  int descriptor() const;

 private:
  bool stop_asked() const noexcept {
    return stays(stop_asked_, [this] { return stop_ && stop_(); });
  }
  template <typename Asked>
  static bool stays(std::atomic<bool>& seen, Asked asked) noexcept {
    if (seen.load(std::memory_order_relaxed)) return true;
    if (!asked()) return false;
    seen.store(true, std::memory_order_relaxed);
    return true;
  }

  std::atomic<bool> cancelled_{false};
  /// What a look found once.
  mutable std::atomic<bool> deadline_passed_{false};
  mutable std::atomic<bool> stop_asked_{false};
  std::optional<Clock::time_point> deadline_;
  const Stop stop_;
  /// Made for the first who asks for it, as few cancellations are waited for.
  mutable std::atomic<WakeEvent*> wake_{nullptr};
};

/// OK, or why the work has to stop: kDeadlineExceeded, kCancelled.
absl::Status check_cancelled(const Cancellation& cancellation);

}  // namespace tet
