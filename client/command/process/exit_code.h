// What a command's exit code says; scripts depend on it.
#pragma once

#include <absl/status/status.h>

namespace tet {

/// A command that a signal stopped exits with 128 plus the signal's number (130 for Ctrl-C).
enum class ExitCode : int {
  kDone = 0,
  kRefused = 1,  ///< the input or the request was refused, or the output cannot be written
  kUsage = 2,    ///< the command line cannot be understood
  kServer = 3,   ///< the server or the network failed
};

/// kDone or kRefused or kServer; kCancelled is for the caller to tell apart.
constexpr ExitCode exit_code_of(absl::StatusCode code) noexcept {
  switch (code) {
    case absl::StatusCode::kOk:
      return ExitCode::kDone;
    case absl::StatusCode::kUnavailable:
    case absl::StatusCode::kDeadlineExceeded:
    case absl::StatusCode::kDataLoss:
    case absl::StatusCode::kInternal:
    case absl::StatusCode::kUnknown:
    case absl::StatusCode::kUnimplemented:
    case absl::StatusCode::kAborted:
      return ExitCode::kServer;
    default:
      return ExitCode::kRefused;
  }
}

}  // namespace tet
