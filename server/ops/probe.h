// Whether something that this process needs works now.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include <absl/status/status.h>

namespace tet {

/// Asks again and again, on a thread of its own, and soon again while the answer is bad. What
/// does not answer at all, a file system that hangs for instance, is told of after a while.
/// Logs `NAME_down` and `NAME_up`. Thread-safe; `status` never waits.
///
/// The destructor waits for an answer that is under way.
class Probe {
 public:
  using Clock = std::chrono::steady_clock;
  using Ask = std::function<absl::Status()>;

  static constexpr std::chrono::seconds kInterval{10};  ///< the disk of an idle server may rest
  static constexpr std::chrono::seconds kInTrouble{1};
  static constexpr std::chrono::seconds kPatience{3};

  /// Waits for the first answer, though not beyond the patience.
  Probe(std::string name, Ask ask, std::chrono::seconds interval = kInterval);
  ~Probe();

  /// The last answer; kUnavailable (NO_ANSWER) while one is overdue.
  absl::Status status() const;

 private:
  void work(const std::stop_token& stopping);
  void watch(const std::stop_token& stopping);
  void tell();
  absl::Status status_now() const;

  const std::string name_;
  const Ask ask_;
  const std::chrono::seconds interval_;
  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  bool has_answered_ = false, is_asking_ = true, was_down_ = false;
  Clock::time_point asked_ = Clock::now();
  absl::Status answer_;
  std::jthread asking_, watching_;  // last: they use all of the above
};

}  // namespace tet
