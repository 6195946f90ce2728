// The memory of a ring, which several streams may use one after the other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include <absl/status/statusor.h>

#include "core/base/posix/sealed_memory.h"

namespace tet {

struct RingSize {
  std::uint64_t blocks = 0;
  std::size_t block_bytes = 0;

  std::uint64_t bytes() const noexcept { return blocks * block_bytes; }
};

/// Blocks that a client reads, charged to it for as long as they are here. When they are not
/// any more, its pages are freed, if they can be: see SealedMemory.
class RingMemory {
 public:
  /// `charged` lives as long as the memory does. Errors: those of SealedMemory::make.
  static absl::StatusOr<std::shared_ptr<RingMemory>> make(RingSize size,
                                                          Readers readers,
                                                          std::string client,
                                                          std::shared_ptr<const void> charged);
  ~RingMemory() { memory_.give_up(); }
  RingMemory(const RingMemory&) = delete;
  RingMemory& operator=(const RingMemory&) = delete;

  const RingSize& size() const noexcept { return size_; }
  /// Whom it is charged to.
  const std::string& client() const noexcept { return client_; }
  const SealedMemory& memory() const noexcept { return memory_; }

 private:
  RingMemory(SealedMemory memory,
             RingSize size,
             std::string client,
             std::shared_ptr<const void> charged)
      : charged_(std::move(charged)),
        memory_(std::move(memory)),
        size_(size),
        client_(std::move(client)) {}

  const std::shared_ptr<const void> charged_;  // goes after the memory
  const SealedMemory memory_;
  const RingSize size_;
  const std::string client_;
};

}  // namespace tet
