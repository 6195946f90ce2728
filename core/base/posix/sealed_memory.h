// Memory that two processes share: one writes, the other reads, and neither can harm the other.
#pragma once

#include <cstddef>
#include <span>
#include <sys/types.h>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "core/base/posix/descriptor.h"

namespace tet {

/// Bytes mapped into this process, until it is destroyed.
class Mapping {
 public:
  Mapping() = default;
  Mapping(void* begin, std::size_t size) noexcept : begin_(begin), size_(size) {}
  ~Mapping();
  Mapping(Mapping&& other) noexcept;
  Mapping& operator=(Mapping&& other) noexcept;

  bool is_there() const noexcept { return begin_ != nullptr; }
  std::byte* begin() const noexcept { return static_cast<std::byte*>(begin_); }
  std::size_t size() const noexcept { return size_; }

 private:
  void* begin_ = nullptr;
  std::size_t size_ = 0;
};

/// Memory that its maker alone writes: it was mapped for writing, and then sealed. Nobody can
/// map it for writing or write to its descriptor any more, nor make it shorter or longer: a
/// reader that may do what it likes cannot change a byte, and cannot have its maker ended by
/// SIGBUS.
class SealedMemory {
 public:
  /// `bytes` of zeros. Errors: kResourceExhausted (no memory, no descriptor), kUnimplemented (a
  /// kernel that does not have these seals).
  static absl::StatusOr<SealedMemory> make(std::size_t bytes);

  /// What is handed to the reader.
  const Descriptor& descriptor() const noexcept { return descriptor_; }
  std::span<std::byte> bytes() const noexcept { return {mapping_.begin(), mapping_.size()}; }

 private:
  Descriptor descriptor_;
  Mapping mapping_;
};

/// Another process's sealed memory, to be read. Trusts nothing: what can become shorter, so
/// that reading it would end this process, is refused. Its bytes may change at any time.
class SharedMemory {
 public:
  /// Maps `bytes` of it. Errors: kInvalidArgument (it is shorter, can become so, or is no
  /// memory), kResourceExhausted (no room for it).
  static absl::StatusOr<SharedMemory> map(const Descriptor& descriptor, std::size_t bytes);

  /// Whether it is `bytes` of the memory that this is a descriptor of.
  bool is_of(const Descriptor& descriptor, std::size_t bytes) const noexcept;

  std::span<const std::byte> bytes() const noexcept {
    return {mapping_.begin(), mapping_.size()};
  }

 private:
  Mapping mapping_;
  dev_t device_ = 0;
  ino_t number_ = 0;  ///< there
};

}  // namespace tet
