#include "server/rpc/grpc_log.h"

#include <atomic>
#include <csignal>
#include <string>
#include <unistd.h>

#include <absl/strings/match.h>
#include <google/protobuf/stubs/logging.h>
#include <grpc/support/log.h>

#include "server/ops/logging.h"
#include "server/ops/sieve.h"
#include "server/rpc/unread_messages.h"

namespace tet {

namespace {

std::atomic<bool> deaf{false};

void end_process(const char* message) {
  if (deaf.exchange(true)) return;
  log_event(spdlog::level::err, "stopped_listening", {{"message", std::string(message)}});
  ::kill(::getpid(), SIGTERM);
}

void log_message(gpr_log_func_args* args) {
  if (absl::StartsWith(args->message, "Failed accept")) return end_process(args->message);
  if (count_compressed(args->message)) return;
  static Sieve sieve;
  const auto left_out = sieve.pass();
  if (!left_out) return;
  log_event(
      args->severity == GPR_LOG_SEVERITY_ERROR ? spdlog::level::warn : spdlog::level::info,
      "grpc", {{"message", std::string(args->message)}, {"left_out", *left_out}});
}

/// Called while messages are parsed, whoever sent them.
void log_protobuf(google::protobuf::LogLevel level,
                  const char* /*file*/,
                  int /*line*/,
                  const std::string& message) {
  static Sieve sieve;
  const auto left_out = sieve.pass();
  if (!left_out) return;
  log_event(
      level >= google::protobuf::LOGLEVEL_ERROR ? spdlog::level::warn : spdlog::level::info,
      "protobuf", {{"message", message}, {"left_out", *left_out}});
}

}  // namespace

bool stopped_listening() noexcept { return deaf; }

void log_grpc_messages() {
  gpr_set_log_function(log_message);
  google::protobuf::SetLogHandler(log_protobuf);
}

}  // namespace tet
