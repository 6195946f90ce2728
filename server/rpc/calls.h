// Running calls: admitted, counted, and logged when they end.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include <absl/status/status.h>
#include <grpcpp/server_context.h>
#include <grpcpp/support/server_callback.h>
#include <nlohmann/json.hpp>

#include "core/base/cancel.h"
#include "core/base/parallel.h"
#include "proto/convert/call_identity.h"
#include "server/ops/metrics.h"
#include "server/rpc/access.h"
#include "server/rpc/admission.h"
#include "server/rpc/client_use.h"
#include "server/rpc/fair_tasks.h"

namespace tet {

class Call;

/// Counts the calls that are running, and those that ended. Thread safety: any thread may call
/// any member.
class CallRegistry {
 public:
  using Clock = std::chrono::steady_clock;

  /// Both references must outlive the registry.
  CallRegistry(Access& access, Admission& admission) : access_(access), admission_(admission) {}

  Access& access() const { return access_; }
  Admission& admission() const { return admission_; }

  /// Hands back what still runs: calls that asked to be told end with kUnavailable as soon as
  /// their transport lets them, and the others find it in `cut_off`.
  void cut();
  /// kUnavailable once the calls that run have been cut.
  absl::Status cut_off() const;
  /// True once no call is running; false at `deadline`.
  bool wait_until_idle(Clock::time_point deadline);
  int running() const;
  Metrics& metrics() { return metrics_; }
  const Metrics& metrics() const { return metrics_; }
  ClientUse& clients() { return clients_; }
  const ClientUse& clients() const { return clients_; }

 private:
  friend class Call;
  void add(int calls);
  void remove(const Call& call);

  Access& access_;
  Admission& admission_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  int running_ = 0;
  bool cut_ = false;
  std::map<const Call*, std::function<void()>> on_cut_;
  Metrics metrics_;
  ClientUse clients_;
};

/// One call, from its arrival until nothing of it is left: counted while it exists, and logged
/// as one line when it finishes. The caller gets its request id as trailing metadata.
///
/// Not thread-safe; the reactor that owns it takes turns.
class Call {
 public:
  Call(CallRegistry& registry, grpc::CallbackServerContext& context, std::string method);
  ~Call();
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;

  CallRegistry& registry() const { return registry_; }
  const std::string& method() const { return method_; }

  /// Errors: those of Access::admit and Admission::admit_call. To be asked before anything
  /// else.
  absl::Status admission() const;

  /// Who calls, as far as we can tell: the token's name, the subject of the client's
  /// certificate, or the host of the peer, without its port.
  const std::string& client() const { return client_; }

  /// What this client has used.
  ClientCounts& use() const { return use_; }

  /// The namespace that the caller's grids are in. Only of a call that was admitted.
  const std::string& space() const { return caller_->space; }

  /// `cut` is called when the server does not wait for this call any longer. It may be called
  /// after the call's end, and must not keep the call alive.
  void on_cut(std::function<void()> cut);

  /// Adds a field to the log line; long text is cut.
  void note(const std::string& key, nlohmann::ordered_json value);

  /// Time since the call arrived.
  double seconds() const;

  /// Logs and counts the call's end, and makes room for the client's next; what it returns is
  /// for gRPC's Finish.
  grpc::Status finish(const absl::Status& status);

 private:
  CallRegistry& registry_;
  const std::string method_;
  const absl::StatusOr<Caller> caller_;
  const std::string client_;
  ClientCounts& use_;
  Ticket ticket_;
  absl::Status admitted_;
  const CallRegistry::Clock::time_point start_ = CallRegistry::Clock::now();
  nlohmann::ordered_json fields_;
};

/// Why a call that was cancelled ends: its deadline, or its client.
absl::Status client_gone(const Cancellation& cancellation);

/// kAborted with reason CLIENT_STALLED: the client `did_what` for so long.
absl::Status client_stalled(const char* did_what, std::chrono::seconds waited);

/// What the gRPC handlers of a unary method have in common: `work` runs on threads that clients
/// share in turns, never on gRPC's own, and its status ends the call.
grpc::ServerUnaryReactor* answer(CallRegistry& registry,
                                 FairTasks& threads,
                                 grpc::CallbackServerContext& context,
                                 std::string method,
                                 std::function<absl::Status(Call&)> work);

/// A unary call whose end comes from elsewhere. Only the first `finish` counts.
class PendingAnswer {
 public:
  PendingAnswer(std::shared_ptr<Call> call,
                grpc::CallbackServerContext& context,
                grpc::ServerUnaryReactor& reactor)
      : call_(std::move(call)), context_(context), reactor_(reactor) {}

  const Call& call() const { return *call_; }
  /// Whether the client has gone. Not after `finish`.
  bool cancelled() const { return context_.IsCancelled(); }
  void finish(const absl::Status& status) {
    if (!finished_.exchange(true)) reactor_.Finish(call_->finish(status));
  }
  void finish_unless_ok(const absl::Status& status) {
    if (!status.ok()) finish(status);
  }

 private:
  std::shared_ptr<Call> call_;
  grpc::CallbackServerContext& context_;
  grpc::ServerUnaryReactor& reactor_;
  std::atomic<bool> finished_{false};
};

/// Answers a call whose work waits, unlike that of `answer`: `begin` runs there and sees to it
/// that somebody finishes the call.
grpc::ServerUnaryReactor* answer_later(
    CallRegistry& registry,
    FairTasks& threads,
    grpc::CallbackServerContext& context,
    std::string method,
    std::function<void(std::shared_ptr<PendingAnswer>)> begin);

}  // namespace tet
