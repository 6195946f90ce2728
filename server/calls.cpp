#include "server/calls.h"

#include <memory>
#include <utility>

#include <absl/strings/str_cat.h>

#include "server/logging.h"
#include "server/status.h"

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

}  // namespace

absl::Status shutting_down() {
  return with_retry(
      with_reason(absl::UnavailableError("the server is shutting down"), "SHUTTING_DOWN"),
      absl::Seconds(1));
}

void CallRegistry::drain() {
  const std::lock_guard lock(mutex_);
  draining_ = true;
}

absl::Status CallRegistry::admission() const {
  const std::lock_guard lock(mutex_);
  return draining_ ? shutting_down() : absl::OkStatus();
}

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
      client_(caller_.ok() ? caller_->name : name_of_peer(context)) {
  registry_.add(1);
  const CallIdentity identity = identify(context);
  tell_identity(identity, context);
  fields_["request_id"] = identity.request_id;
  fields_["method"] = method_;
  note("client", client_);
  fields_["peer"] = context.peer();
  fields_["user_agent"] = identity.user_agent;
  if (identity.span.trace_id.empty()) return;
  fields_["trace_id"] = identity.span.trace_id;
  fields_["span_id"] = identity.span.span_id;
  fields_["parent_id"] = identity.span.parent_id;
}

Call::~Call() { registry_.remove(*this); }

void Call::on_cut(std::function<void()> cut) {
  const std::lock_guard lock(registry_.mutex_);
  registry_.on_cut_[this] = std::move(cut);
}

absl::Status Call::admission() const {
  return caller_.ok() ? registry_.admission() : caller_.status();
}

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
  fields_["status"] = absl::StatusCodeToString(status.code());
  if (!status.ok()) note("reason", reason);
  fields_["duration_ms"] = 1e3 * seconds();
  if (!status.ok()) note("message", std::string(status.message()));
  log_event(level_of(status), "call", fields_);
  return to_grpc(status);
}

grpc::ServerUnaryReactor* answer(CallRegistry& registry,
                                 TaskPool& disk,
                                 grpc::CallbackServerContext& context,
                                 std::string method,
                                 std::function<absl::Status(Call&)> work) {
  auto call = std::make_shared<Call>(registry, context, std::move(method));
  grpc::ServerUnaryReactor* reactor = context.DefaultReactor();
  disk.post([call, reactor, work = std::move(work)] {
    const absl::Status admitted = call->admission();
    reactor->Finish(call->finish(admitted.ok() ? work(*call) : admitted));
  });
  return reactor;
}

grpc::ServerUnaryReactor* answer_later(
    CallRegistry& registry,
    TaskPool& disk,
    grpc::CallbackServerContext& context,
    std::string method,
    std::function<void(std::shared_ptr<PendingAnswer>)> begin) {
  auto call = std::make_shared<Call>(registry, context, std::move(method));
  grpc::ServerUnaryReactor* reactor = context.DefaultReactor();
  auto pending = std::make_shared<PendingAnswer>(call, context, *reactor);
  disk.post([call, pending, begin = std::move(begin)] {
    const absl::Status admitted = call->admission();
    admitted.ok() ? begin(pending) : pending->finish(admitted);
  });
  return reactor;
}

}  // namespace tet
