#include "client/library/client_call.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <random>
#include <string>
#include <utility>

#include <absl/strings/str_format.h>

#include "client/library/error_details.h"

namespace tet {

namespace {

/// How long the caller seeks a server before it looks for a cancellation again.
constexpr std::chrono::milliseconds kSought{25};

/// No server may keep us waiting longer than this.
constexpr absl::Duration kLongestWait = absl::Seconds(30);

/// An upload whose offset is wrong, too: what the call that broke had sent may still be taken
/// when the next one has been told how far it came.
bool worth_retrying(const absl::Status& status) {
  return absl::IsUnavailable(status) || absl::IsAborted(status) || retry_delay(status) ||
         reason_of_failure(status) == "WRONG_OFFSET";
}

/// A name of its own for every attempt, and the trace that this process is part of, if any.
void add_identity(grpc::ClientContext& context) {
  static thread_local std::mt19937_64 random{std::random_device{}()};
  context.AddMetadata("x-request-id", absl::StrFormat("%016x", random()));
  const char* const trace = std::getenv("TRACEPARENT");
  const std::string_view text = trace == nullptr ? "" : trace;
  constexpr std::string_view kDigits = "0123456789abcdef-";
  if (text.size() != 55 || text.find_first_not_of(kDigits) != std::string_view::npos) return;
  context.AddMetadata("traceparent", std::string(text));
}

}  // namespace

ClientCall::ClientCall(ServerChannel channel, const Cancellation& cancellation)
    : channel_(std::move(channel)),
      cancellation_(cancellation),
      on_cancel_(cancellation, [this] { context_.TryCancel(); }) {
  add_identity(context_);
  channel_.authorize(context_);
}

absl::Status ClientCall::result(const grpc::Status& status) const {
  if (status.ok()) return absl::OkStatus();
  if (const absl::Status cancelled = check(cancellation_); !cancelled.ok()) return cancelled;
  const absl::Status ours = channel_.explain(to_absl(status, context_));
  // Not by us: a call that reaches a server just when it closes its port is dropped like that.
  if (absl::IsCancelled(ours) && reason_of_failure(ours).empty()) {
    return absl::UnavailableError("the server dropped the call");
  }
  return ours;
}

absl::Status check(const Cancellation& cancellation) {
  if (!cancellation.requested()) return absl::OkStatus();
  if (cancellation.deadline_passed()) return absl::DeadlineExceededError("the deadline passed");
  return absl::CancelledError("cancelled");
}

absl::Status Retries::again(const absl::Status& status,
                            std::uint64_t progress,
                            const ServerChannel& next,
                            RetryHint hint) {
  if (!worth_retrying(status)) return status;
  if (progress > furthest_) failures_ = 0;
  furthest_ = std::max(furthest_, progress);
  const int attempts = hint.known && policy_.attempts > 1
                           ? std::max(policy_.attempts, policy_.attempts_once_known)
                           : policy_.attempts;
  if (++failures_ >= attempts) return status;
  const auto asked = hint.elsewhere ? std::nullopt : retry_delay(status);
  const auto wait = next_wait(asked.value_or(absl::ZeroDuration()));
  const auto end = std::chrono::steady_clock::now() + wait;
  while (std::chrono::steady_clock::now() < end && !cancellation_.requested()) {
    next.seek(std::min(kSought, wait));
  }
  return check(cancellation_);
}

std::chrono::milliseconds Retries::next_wait(absl::Duration asked) {
  const int doubled = policy_.first_backoff_ms << std::min(failures_ - 1, 16);
  const auto backoff = absl::Milliseconds(std::min(doubled, policy_.max_backoff_ms));
  std::uniform_real_distribution<double> chance(1, 1.25);
  return absl::ToChronoMilliseconds(std::max(backoff, std::min(asked, kLongestWait)) *
                                    chance(random_));
}

}  // namespace tet
