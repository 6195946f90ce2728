// Running calls: admitted, counted, and logged when they end.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>

#include <absl/status/status.h>
#include <grpcpp/server_context.h>
#include <grpcpp/support/server_callback.h>
#include <nlohmann/json.hpp>

#include "core/base/cancel.h"
#include "core/base/parallel.h"
#include "server/admission.h"

namespace tet {

/// Counts the calls that are running. Thread safety: any thread may call any member.
class CallRegistry {
 public:
  using Clock = std::chrono::steady_clock;

  explicit CallRegistry(Admission& admission) : admission_(admission) {}

  Admission& admission() const { return admission_; }
  /// True once no call is running; false at `deadline`.
  bool wait_until_idle(Clock::time_point deadline);
  int running() const;

 private:
  friend class Call;
  void add(int calls);

  Admission& admission_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  int running_ = 0;
};

/// One call, from its arrival until nothing of it is left: counted while it exists, and logged
/// as one line when it finishes.
///
/// Not thread-safe; the reactor that owns it takes turns.
class Call {
 public:
  Call(CallRegistry& registry, const grpc::CallbackServerContext& context, std::string method);
  ~Call();
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;

  CallRegistry& registry() const { return registry_; }
  /// Whether it may go on. Errors: those of Admission::admit_call.
  const absl::Status& admitted() const { return admitted_; }

  /// Who calls, as far as we can tell: the host of the peer, without its port.
  const std::string& client() const { return client_; }

  /// Adds a field to the log line.
  void note(const std::string& key, nlohmann::ordered_json value);

  /// Logs the call's end, and makes room for the client's next; what it returns is for gRPC's
  /// Finish.
  grpc::Status finish(const absl::Status& status);

 private:
  CallRegistry& registry_;
  const std::string client_;
  Ticket ticket_;
  absl::Status admitted_;
  const CallRegistry::Clock::time_point start_ = CallRegistry::Clock::now();
  nlohmann::ordered_json fields_;
};

/// Why a call that was cancelled ends: its deadline, or its client.
absl::Status client_gone(const Cancellation& cancellation);

/// kAborted with reason CLIENT_STALLED: the client `did_what` for so long.
absl::Status client_stalled(const char* did_what, std::chrono::seconds waited);

/// What the gRPC handlers of a unary method have in common: `work` runs on `disk`, never on
/// gRPC's own threads, and its status ends the call.
grpc::ServerUnaryReactor* answer(CallRegistry& registry,
                                 TaskPool& disk,
                                 grpc::CallbackServerContext& context,
                                 std::string method,
                                 std::function<absl::Status(Call&)> work);

}  // namespace tet
