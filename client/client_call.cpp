#include "client/client_call.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <stop_token>
#include <string>
#include <utility>

namespace tet {

namespace {

constexpr std::chrono::milliseconds kPoll{25};

/// Waits for `time`, or less when a stop is requested.
void pause(const std::stop_token& stop, std::chrono::milliseconds time) {
  std::mutex mutex;
  std::condition_variable_any never;
  std::unique_lock lock(mutex);
  never.wait_for(lock, stop, time, [] { return false; });
}

bool worth_retrying(const absl::Status& status) {
  return absl::IsUnavailable(status) || absl::IsAborted(status);
}

}  // namespace

ClientCall::ClientCall(ServerChannel channel, const Cancellation& cancellation)
    : channel_(std::move(channel)),
      cancellation_(cancellation),
      watcher_([this](const std::stop_token& stop) {
        while (!stop.stop_requested() && !cancellation_.requested()) pause(stop, kPoll);
        if (cancellation_.requested()) context_.TryCancel();
      }) {
  channel_.authorize(context_);
}

absl::Status ClientCall::result(const grpc::Status& status) const {
  if (status.ok()) return absl::OkStatus();
  if (const absl::Status cancelled = check(cancellation_); !cancelled.ok()) return cancelled;
  return channel_.explain(status);
}

absl::Status check(const Cancellation& cancellation) {
  if (!cancellation.requested()) return absl::OkStatus();
  if (cancellation.deadline_passed()) return absl::DeadlineExceededError("the deadline passed");
  return absl::CancelledError("cancelled");
}

bool Retries::again(const absl::Status& status, std::uint64_t progress) {
  if (!worth_retrying(status)) return false;
  if (progress > furthest_) failures_ = 0;
  furthest_ = std::max(furthest_, progress);
  if (++failures_ >= policy_.attempts) return false;
  const int backoff = policy_.first_backoff_ms << std::min(failures_ - 1, 16);
  const auto wait = std::chrono::milliseconds(std::min(backoff, policy_.max_backoff_ms));
  const auto end = std::chrono::steady_clock::now() + wait;
  while (std::chrono::steady_clock::now() < end && !cancellation_.requested()) {
    std::this_thread::sleep_for(std::min(kPoll, wait));
  }
  return !cancellation_.requested();
}

}  // namespace tet
