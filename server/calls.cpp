#include "server/calls.h"

#include <memory>
#include <random>
#include <utility>

#include <absl/strings/match.h>
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

/// "ipv4:10.0.0.7:51234" is of "10.0.0.7"; a peer of another form is its own name.
std::string host_of(const std::string& peer) {
  const std::size_t scheme = peer.find(':');
  const std::size_t port = peer.rfind(':');
  if (!absl::StartsWith(peer, "ipv") || port == scheme) return peer;
  return peer.substr(scheme + 1, port - scheme - 1);
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
    : registry_(registry), client_(host_of(context.peer())) {
  auto ticket = registry.admission().admit_call(client_);
  admitted_ = ticket.status();
  if (ticket.ok()) ticket_ = *std::move(ticket);
  registry_.add(1);
  fields_["request_id"] = request_id(context);
  fields_["method"] = std::move(method);
  fields_["peer"] = context.peer();
}

// Whoever waits for the registry to be idle may destroy the admission next.
Call::~Call() {
  ticket_.reset();
  registry_.add(-1);
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
  ticket_.reset();
  return to_grpc(status);
}

absl::Status client_gone(const Cancellation& cancellation) {
  if (cancellation.deadline_passed()) return absl::DeadlineExceededError("the deadline passed");
  return absl::CancelledError("the client went away");
}

absl::Status client_stalled(const char* did_what, std::chrono::seconds waited) {
  return with_reason(absl::AbortedError(absl::StrCat("the client ", did_what, " for ",
                                                     waited.count(), " s; resume to go on")),
                     "CLIENT_STALLED");
}

grpc::ServerUnaryReactor* answer(CallRegistry& registry,
                                 TaskPool& disk,
                                 grpc::CallbackServerContext& context,
                                 std::string method,
                                 std::function<absl::Status(Call&)> work) {
  auto call = std::make_shared<Call>(registry, context, std::move(method));
  grpc::ServerUnaryReactor* reactor = context.DefaultReactor();
  if (!call->admitted().ok()) {
    reactor->Finish(call->finish(call->admitted()));
  } else {
    disk.post([call, reactor, work = std::move(work)] {
      reactor->Finish(call->finish(work(*call)));
    });
  }
  return reactor;
}

}  // namespace tet
