// What every call of the client has in common: cancellation, statuses, and trying again.
#pragma once

#include <chrono>
#include <cstdint>
#include <random>

#include <absl/status/status.h>
#include <grpcpp/client_context.h>
#include <grpcpp/support/status.h>

#include "client/library/channel.h"
#include "client/library/mesh_client.h"
#include "core/base/cancel.h"
#include "core/base/on_cancel.h"

namespace tet {

/// One attempt at a call: its context, cancelled when `cancellation` is raised.
class ClientCall {
 public:
  ClientCall(ServerChannel channel, const Cancellation& cancellation);

  grpc::ClientContext& context() { return context_; }

  /// The server's status as ours, with its details; when the caller has cancelled, that is the
  /// reason given.
  absl::Status result(const grpc::Status& status) const;

 private:
  const ServerChannel channel_;
  const Cancellation& cancellation_;
  grpc::ClientContext context_;
  const OnCancel on_cancel_;  // last: it uses the others
};

/// kCancelled or kDeadlineExceeded when `cancellation` was raised, else kOk.
absl::Status check(const Cancellation& cancellation);

/// What the connection knows of the next attempt.
struct RetryHint {
  bool elsewhere = false;  ///< it is made at another server, which did not ask for time
  bool known = false;      ///< some server has answered before
};

/// Decides how often, and after how long, a failed call is taken up again: when the connection
/// broke, when the call met another, and when the server says that it is worth it.
class Retries {
 public:
  Retries(const RetryPolicy& policy, const Cancellation& cancellation)
      : policy_(policy), cancellation_(cancellation) {}

  /// After a failed attempt that got as far as `progress`: seeks `next` for a while and returns
  /// OK when it is worth another there; else why the call ends, which is `status`, or that it
  /// was cancelled or its deadline passed during the wait. Attempts count from the last one
  /// that got further than those before. The wait is what the server asked for at least, a
  /// little longer by chance, so that clients that failed together come back one by one.
  absl::Status again(const absl::Status& status,
                     std::uint64_t progress,
                     const ServerChannel& next,
                     RetryHint hint);

 private:
  std::chrono::milliseconds next_wait(absl::Duration asked);

  const RetryPolicy policy_;
  const Cancellation& cancellation_;
  std::mt19937 random_{std::random_device{}()};
  int failures_ = 0;
  std::uint64_t furthest_ = 0;
};

}  // namespace tet
