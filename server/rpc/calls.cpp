#include "server/rpc/calls.h"

#include <memory>
#include <utility>

#include <absl/strings/str_cat.h>

#include "core/base/printable.h"
#include "proto/convert/status.h"
#include "server/ops/guard.h"
#include "server/ops/logging.h"
#include "server/rpc/forwarded.h"

namespace tet {

namespace {

constexpr std::size_t kMaxLoggedText = 300;

spdlog::level::level_enum level_of(const absl::Status& status) {
  switch (status.code()) {
    case absl::StatusCode::kOk:
      return spdlog::level::info;
    case absl::StatusCode::kInternal:
    case absl::StatusCode::kUnknown:
    case absl::StatusCode::kDataLoss:
      return spdlog::level::err;
    default:
      return spdlog::level::warn;
  }
}

/// Whether an operator has named whoever made a call that was let in.
bool has_name(const Access& access, const grpc::ServerContextBase& context) {
  return access.needs_token() || !peer_of(context).subject.empty();
}

}  // namespace

void CallRegistry::cut() {
  std::map<const Call*, std::function<void()>> running;
  {
    const std::lock_guard lock(mutex_);
    cut_ = true;
    running = on_cut_;
  }
  for (const auto& [call, cut_call] : running) cut_call();
}

absl::Status CallRegistry::cut_off() const {
  const std::lock_guard lock(mutex_);
  return cut_ ? shutting_down() : absl::OkStatus();
}

bool CallRegistry::wait_until_idle(Clock::time_point deadline) {
  std::unique_lock lock(mutex_);
  return changed_.wait_until(lock, deadline, [&] { return running_ == 0; });
}

int CallRegistry::running() const {
  const std::lock_guard lock(mutex_);
  return running_;
}

// Notifies under the lock: the registry may be destroyed as soon as a waiter sees it idle.
void CallRegistry::add(int calls) {
  const std::lock_guard lock(mutex_);
  running_ += calls;
  changed_.notify_all();
}

void CallRegistry::remove(const Call& call) {
  {
    const std::lock_guard lock(mutex_);
    on_cut_.erase(&call);
  }
  add(-1);
}

Call::Call(CallRegistry& registry, grpc::CallbackServerContext& context, std::string method)
    : registry_(registry),
      method_(std::move(method)),
      caller_(registry.access().admit(context, method_)),
      client_(caller_.ok() ? caller_->name : name_of_peer(context)),
      use_(caller_.ok() && has_name(registry.access(), context)
               ? registry.clients().name(client_)
               : registry.clients().of(client_)) {
  auto ticket = registry.admission().admit_call(client_);
  admitted_ = ticket.status();
  if (ticket.ok()) ticket_ = *std::move(ticket);
  registry_.add(1);
  const CallIdentity identity = identify(context);
  tell_identity(identity, context);
  fields_["request_id"] = identity.request_id;
  fields_["method"] = method_;
  note("client", client_);
  note("peer", peer_of(context).address);
  fields_["user_agent"] = identity.user_agent;
  if (identity.span.trace_id.empty()) return;
  fields_["trace_id"] = identity.span.trace_id;
  fields_["span_id"] = identity.span.span_id;
  fields_["parent_id"] = identity.span.parent_id;
}

// Whoever waits for the registry to be idle may destroy the admission next.
Call::~Call() {
  ticket_.reset();
  registry_.remove(*this);
}

void Call::on_cut(std::function<void()> cut) {
  const std::lock_guard lock(registry_.mutex_);
  registry_.on_cut_[this] = std::move(cut);
}

absl::Status Call::admission() const { return caller_.ok() ? admitted_ : caller_.status(); }

void Call::note(const std::string& key, nlohmann::ordered_json value) {
  if (value.is_string()) value = printable(value.get_ref<std::string&>(), kMaxLoggedText);
  fields_[key] = std::move(value);
}

double Call::seconds() const {
  return std::chrono::duration<double>(CallRegistry::Clock::now() - start_).count();
}

grpc::Status Call::finish(const absl::Status& status) {
  const std::string reason = reason_of(status);
  registry_.metrics().call_ended(method_, status.code(), reason, seconds());
  ++use_.calls;
  if (!status.ok()) ++use_.refusals;
  fields_["status"] = absl::StatusCodeToString(status.code());
  if (!status.ok()) note("reason", reason);
  fields_["duration_ms"] = 1e3 * seconds();
  if (!status.ok()) note("message", std::string(status.message()));
  log_event(level_of(status), "call", fields_);
  ticket_.reset();
  return to_grpc(status);
}

absl::Status client_gone(const Cancellation& cancellation) {
  if (cancellation.deadline_passed()) {
    return with_reason(absl::DeadlineExceededError("the deadline passed"), "DEADLINE_EXCEEDED");
  }
  return with_reason(absl::CancelledError("the client went away"), "CANCELLED");
}

absl::Status client_stalled(const char* did_what, std::chrono::seconds waited) {
  return with_reason(absl::AbortedError(absl::StrCat("the client ", did_what, " for ",
                                                     waited.count(), " s; resume to go on")),
                     "CLIENT_STALLED");
}

grpc::ServerUnaryReactor* answer(CallRegistry& registry,
                                 FairTasks& threads,
                                 grpc::CallbackServerContext& context,
                                 std::string method,
                                 std::function<absl::Status(Call&)> work) {
  const auto call = std::make_shared<Call>(registry, context, std::move(method));
  grpc::ServerUnaryReactor* reactor = context.DefaultReactor();
  if (const absl::Status admitted = call->admission(); !admitted.ok()) {
    reactor->Finish(call->finish(admitted));
    return reactor;
  }
  threads.post(call->client(), [call, reactor, work = std::move(work)] {
    reactor->Finish(call->finish(guarded(call->method().c_str(), [&] { return work(*call); })));
  });
  return reactor;
}

grpc::ServerUnaryReactor* answer_later(
    CallRegistry& registry,
    FairTasks& threads,
    grpc::CallbackServerContext& context,
    std::string method,
    std::function<void(std::shared_ptr<PendingAnswer>)> begin) {
  auto call = std::make_shared<Call>(registry, context, std::move(method));
  grpc::ServerUnaryReactor* reactor = context.DefaultReactor();
  auto pending = std::make_shared<PendingAnswer>(call, context, *reactor);
  if (const absl::Status admitted = call->admission(); !admitted.ok()) {
    pending->finish(admitted);
  } else {
    threads.post(call->client(), [pending, begin = std::move(begin)] {
      pending->finish_unless_ok(
          guarded(pending->call().method().c_str(), [&] { begin(pending); }));
    });
  }
  return reactor;
}

}  // namespace tet
