#include "server/calls.h"

#include <memory>
#include <random>
#include <utility>

#include <absl/strings/str_cat.h>

#include "server/logging.h"
#include "server/status.h"

namespace tet {

namespace {

constexpr char kRequestIdKey[] = "x-request-id";

/// The caller's own id if it sent one of sensible size, else a random one.
std::string request_id(const grpc::CallbackServerContext& context) {
  const auto& metadata = context.client_metadata();
  const auto found = metadata.find(kRequestIdKey);
  if (found != metadata.end() && found->second.size() <= 128) {
    return {found->second.data(), found->second.size()};
  }
  static thread_local std::mt19937_64 random{std::random_device{}()};
  return absl::StrCat(absl::Hex(random(), absl::kZeroPad16));
}

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

void CallRegistry::drain() {
  const std::lock_guard lock(mutex_);
  draining_ = true;
}

absl::Status CallRegistry::admission() const {
  const std::lock_guard lock(mutex_);
  if (!draining_) return absl::OkStatus();
  return with_retry(
      with_reason(absl::UnavailableError("the server is shutting down"), "SHUTTING_DOWN"),
      absl::Seconds(1));
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

Call::Call(CallRegistry& registry,
           const grpc::CallbackServerContext& context,
           std::string method)
    : registry_(registry),
      caller_(registry.access().admit(context, method)),
      client_(caller_.ok() ? caller_->name : name_of_peer(context)) {
  registry_.add(1);
  fields_["request_id"] = request_id(context);
  fields_["method"] = std::move(method);
  fields_["peer"] = context.peer();
}

Call::~Call() { registry_.add(-1); }

absl::Status Call::admission() const {
  return caller_.ok() ? registry_.admission() : caller_.status();
}

void Call::note(const std::string& key, nlohmann::ordered_json value) {
  fields_[key] = std::move(value);
}

grpc::Status Call::finish(const absl::Status& status) {
  const std::chrono::duration<double, std::milli> duration =
      CallRegistry::Clock::now() - start_;
  fields_["status"] = absl::StatusCodeToString(status.code());
  fields_["duration_ms"] = duration.count();
  if (!status.ok()) fields_["message"] = std::string(status.message());
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

}  // namespace tet
