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
  /// Time has passed: told every now and then.
  virtual void pass_time(Clock::time_point /*now*/) {}
  /// Ends the call, whose client has not moved for so long.
  virtual void give_up(std::chrono::seconds waited) = 0;
};

/// Gives up calls that wait for too long. Thread-safe.
class StallWatch {
 public:
  void add(std::weak_ptr<Stallable> call);

  /// Tells all of the time, and gives up what has waited for `limit` at `now`; to be called
  /// every now and then.
  void check(Stallable::Clock::time_point now, std::chrono::seconds limit);

 private:
  std::vector<std::shared_ptr<Stallable>> calls();

  std::mutex mutex_;
  std::vector<std::weak_ptr<Stallable>> calls_;
};

}  // namespace tet
