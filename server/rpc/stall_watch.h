// Calls that wait for their clients, and not for ever.
#pragma once

#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

namespace tet {

/// A call that may wait for its client. Thread-safe.
class Stallable {
 public:
  using Clock = std::chrono::steady_clock;

  virtual ~Stallable() = default;
  /// Since when it waits; nothing while it does not.
  virtual std::optional<Clock::time_point> waiting_since() = 0;
  struct Wait {
    Clock::time_point since;
    std::chrono::seconds most;  ///< that it may take
  };
  /// What it waits for, where any call may wait for `limit`; nothing while it does not.
  virtual std::optional<Wait> wait(std::chrono::seconds limit) {
    const auto since = waiting_since();
    return since ? std::optional<Wait>({*since, limit}) : std::nullopt;
  }
  /// Time has passed: told every now and then.
  virtual void pass_time(Clock::time_point /*now*/) {}
  /// Ends the call, whose client has not moved for so long.
  virtual void give_up(std::chrono::seconds waited) = 0;
};

/// Gives up calls that wait for too long. Thread-safe.
class StallWatch {
 public:
  void add(std::weak_ptr<Stallable> call);

  /// Tells all of the time, and gives up what has waited for too long at `now`: for `limit`,
  /// unless it has another of its own. To be called every now and then.
  void check(Stallable::Clock::time_point now, std::chrono::seconds limit);

 private:
  std::vector<std::shared_ptr<Stallable>> calls();

  std::mutex mutex_;
  std::vector<std::weak_ptr<Stallable>> calls_;
};

}  // namespace tet
