#include "bench/load/dispatcher.h"

#include <optional>
#include <utility>

namespace tet::load {

namespace {
constexpr std::chrono::milliseconds kGiveUpInterval{20};
}

Dispatcher::Dispatcher(const LoadPlan& plan,
                       RequestSender& sender,
                       LoadStatistics& statistics,
                       std::function<void(const absl::Status&)> answered)
    : plan_(plan), sender_(sender), statistics_(statistics), answered_(std::move(answered)) {}

void Dispatcher::offer(LoadRequest request) {
  statistics_.offered(request);
  {
    const std::lock_guard lock(mutex_);
    if (outstanding_ >= plan_.max_outstanding) {
      if (queue_.size() < plan_.max_queued) {
        queue_.push_back(std::move(request));
      } else {
        statistics_.dropped(request);
      }
      return;
    }
    ++outstanding_;
  }
  send(request, false);
}

void Dispatcher::send(const LoadRequest& request, bool queued) {
  statistics_.sent(request, Clock::now(), queued);
  sender_.send(request, [this, request](const Outcome& outcome) { ended(request, outcome); });
}

void Dispatcher::ended(const LoadRequest& request, const Outcome& outcome) {
  std::optional<LoadRequest> next;
  bool gave_up = false;
  {
    const std::lock_guard lock(mutex_);
    gave_up = gave_up_;
    if (!queue_.empty()) {
      next = std::move(queue_.front());
      queue_.pop_front();
    } else {
      --outstanding_;  // before its worker is free for another
      ++ending_;
    }
  }
  book(request, outcome, gave_up);
  if (answered_) answered_(outcome.status);
  if (next) return send(*next, true);
  const std::lock_guard lock(mutex_);
  --ending_;
  if (is_idle()) idle_.notify_all();
}

void Dispatcher::book(const LoadRequest& request, const Outcome& outcome, bool gave_up) {
  if (outcome.status.ok()) return statistics_.done(request, outcome);
  if (gave_up && absl::IsCancelled(outcome.status)) {
    return statistics_.unfinished(request, outcome);
  }
  statistics_.failed(request, outcome.status);
}

bool Dispatcher::wait_until_idle(Nanoseconds time) {
  std::unique_lock lock(mutex_);
  return idle_.wait_for(lock, time, [this] { return is_idle(); });
}

void Dispatcher::give_up() {
  std::deque<LoadRequest> never_sent;
  {
    const std::lock_guard lock(mutex_);
    gave_up_ = true;
    never_sent.swap(queue_);
  }
  Outcome never_came;
  never_came.ended = Clock::now();
  for (const LoadRequest& request : never_sent) statistics_.unfinished(request, never_came);
  // Again and again: one that ended a moment ago may just be sending the next.
  do {
    sender_.give_up();
  } while (!wait_until_idle(kGiveUpInterval));
}

std::size_t Dispatcher::outstanding() const {
  const std::lock_guard lock(mutex_);
  return outstanding_;
}

std::size_t Dispatcher::queued() const {
  const std::lock_guard lock(mutex_);
  return queue_.size();
}

}  // namespace tet::load
