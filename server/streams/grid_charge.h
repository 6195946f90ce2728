// Memory that sessions take for their frames, beside the grids of files.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>

#include <absl/status/status.h>

namespace tet {

/// What one frame has of the memory of all sessions; counts for as long as this is there. `all`
/// outlives it.
class GridCharge {
 public:
  GridCharge(std::atomic<std::uint64_t>& all, std::uint64_t limit) : all_(all), limit_(limit) {}
  ~GridCharge() { all_.fetch_sub(bytes_); }
  GridCharge(const GridCharge&) = delete;
  GridCharge& operator=(const GridCharge&) = delete;

  /// Takes so much more. To be asked before the memory is taken. Errors: kResourceExhausted
  /// with LIMIT_EXCEEDED (it could never have that), or with SERVER_BUSY (others have the
  /// rest); then it has what it had.
  absl::Status add(std::uint64_t bytes);

  /// Keeps only so much.
  void shrink_to(std::uint64_t bytes);

 private:
  std::atomic<std::uint64_t>& all_;
  const std::uint64_t limit_;
  std::uint64_t bytes_ = 0;
};

}  // namespace tet
