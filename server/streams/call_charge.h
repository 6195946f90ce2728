// Memory that calls take for what their clients send, beside the grids of files.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>

#include <absl/status/status.h>

namespace tet {

/// What one call, or one frame of it, has of memory that all calls of its kind share; counts
/// for as long as this is there. `what` names that memory in failures, and `all` counts it:
/// both outlive this.
class CallCharge {
 public:
  CallCharge(const char* what, std::atomic<std::uint64_t>& all, std::uint64_t limit)
      : what_(what), all_(all), limit_(limit) {}
  ~CallCharge() { all_.fetch_sub(bytes_); }
  CallCharge(const CallCharge&) = delete;
  CallCharge& operator=(const CallCharge&) = delete;

  /// Takes so much more. To be asked before the memory is taken. Errors: kResourceExhausted
  /// with LIMIT_EXCEEDED (it could never have that), or with SERVER_BUSY (others have the
  /// rest); then it has what it had.
  absl::Status add(std::uint64_t bytes);

  /// Keeps only so much.
  void shrink_to(std::uint64_t bytes);

 private:
  const char* const what_;
  std::atomic<std::uint64_t>& all_;
  const std::uint64_t limit_;
  std::uint64_t bytes_ = 0;
};

}  // namespace tet
