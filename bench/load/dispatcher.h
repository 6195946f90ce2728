// Sends what is due, as far as the cap on outstanding requests allows, and books what becomes
// of it.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>

#include "bench/load/load_plan.h"
#include "bench/load/load_statistics.h"
#include "bench/load/request_sender.h"

namespace tet::load {

/// Requests over the cap wait in a queue, their latency counting all the while; those over the
/// queue's length are dropped and counted. Thread safety: any thread may call any member.
class Dispatcher {
 public:
  /// `answered` is told of every request that ends, on the sender's threads.
  Dispatcher(const LoadPlan& plan,
             RequestSender& sender,
             LoadStatistics& statistics,
             std::function<void(const absl::Status&)> answered = {});

  /// A request is due now.
  void offer(LoadRequest request);

  /// Waits until nothing is outstanding, at most `time`; false when something still is.
  bool wait_until_idle(Nanoseconds time);

  /// Forgets the queue, cancels what is outstanding and waits for it to end.
  void give_up();

  std::size_t outstanding() const;
  std::size_t queued() const;

 private:
  void send(const LoadRequest& request, bool queued);
  void ended(const LoadRequest& request, const Outcome& outcome);
  void book(const LoadRequest& request, const Outcome& outcome, bool gave_up);
  bool is_idle() const noexcept { return outstanding_ == 0 && ending_ == 0; }

  const LoadPlan& plan_;
  RequestSender& sender_;
  LoadStatistics& statistics_;
  const std::function<void(const absl::Status&)> answered_;
  mutable std::mutex mutex_;
  std::condition_variable idle_;
  std::deque<LoadRequest> queue_;
  std::size_t outstanding_ = 0;
  std::size_t ending_ = 0;  ///< answered, and not yet booked
  bool gave_up_ = false;
};

}  // namespace tet::load
