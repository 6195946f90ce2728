#include "server/rpc/grpc_log.h"

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <mutex>
#include <string>
#include <unistd.h>
#include <utility>

#include <absl/strings/match.h>
#include <grpc/support/log.h>

#include "server/ops/logging.h"

namespace tet {

namespace {

constexpr std::chrono::seconds kInterval{1};

/// Lets one message through in each interval, and counts the others.
class Sieve {
 public:
  /// -1: not this one; else how many were left out before it.
  std::int64_t left_out() {
    const std::lock_guard lock(mutex_);
    const auto now = std::chrono::steady_clock::now();
    if (now < next_) {
      ++left_out_;
      return -1;
    }
    next_ = now + kInterval;
    return std::exchange(left_out_, 0);
  }

 private:
  std::mutex mutex_;
  std::chrono::steady_clock::time_point next_;
  std::int64_t left_out_ = 0;
};

std::atomic<bool> deaf{false};

void end_process(const char* message) {
  if (deaf.exchange(true)) return;
  log_event(spdlog::level::err, "stopped_listening", {{"message", std::string(message)}});
  ::kill(::getpid(), SIGTERM);
}

void log_message(gpr_log_func_args* args) {
  if (absl::StartsWith(args->message, "Failed accept")) return end_process(args->message);
  static Sieve sieve;
  const std::int64_t left_out = sieve.left_out();
  if (left_out < 0) return;
  log_event(
      args->severity == GPR_LOG_SEVERITY_ERROR ? spdlog::level::warn : spdlog::level::info,
      "grpc", {{"message", std::string(args->message)}, {"left_out", left_out}});
}

}  // namespace

bool stopped_listening() noexcept { return deaf; }

void log_grpc_messages() { gpr_set_log_function(log_message); }

}  // namespace tet
