// Memory handed from one process to another, which nobody can change any more.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "core/base/posix/descriptor.h"

namespace tet {

/// Empty memory that another process may fill and seal. Errors: kUnavailable (the system has
/// none).
absl::StatusOr<Descriptor> make_sealable_memory();

/// Takes from everybody, the caller included, all that could change the memory or its size.
/// Errors: kInternal (something still may write it).
absl::Status seal_memory(int descriptor);

/// A mapping of sealed memory, aligned to a page; unmapped when it is destroyed.
class SealedBlock {
 public:
  /// Errors: kInvalidArgument (not sealed, so that it might change while it is read; empty,
  /// larger than `max_bytes`, or with holes), kUnavailable (cannot be mapped).
  static absl::StatusOr<SealedBlock> map(int descriptor, std::uint64_t max_bytes);

  ~SealedBlock();
  SealedBlock(SealedBlock&& other) noexcept : bytes_(std::exchange(other.bytes_, {})) {}
  SealedBlock& operator=(SealedBlock&& other) noexcept {
    std::swap(bytes_, other.bytes_);
    return *this;
  }

  std::span<const std::byte> bytes() const noexcept { return bytes_; }

 private:
  explicit SealedBlock(std::span<const std::byte> bytes) : bytes_(bytes) {}

  std::span<const std::byte> bytes_;
};

}  // namespace tet
