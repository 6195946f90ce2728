// Large blocks of memory that messages are made in and sent from, used again and again.
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <vector>

#include <grpcpp/support/slice.h>

namespace tet {

/// Keeps blocks of one size, so that streaming neither allocates nor touches fresh pages.
/// Thread-safe. Blocks may come back after the pool is gone: gRPC lets go of them when it
/// likes.
class BlockPool {
 public:
  /// `block_bytes` of each block; at most `max_idle` wait to be used again, more are freed.
  BlockPool(std::size_t block_bytes, std::size_t max_idle);

  /// Memory of at least `size` bytes, from the pool if it is no larger than its blocks, as a
  /// slice of just that size at a multiple of 64. The last slice of it to go gives it back, and
  /// lets go of `held`.
  grpc::Slice take(std::size_t size, std::shared_ptr<void> held = nullptr);

  /// Blocks waiting to be used again.
  std::size_t idle() const;

 private:
  struct Block;
  struct Shelf;
  std::shared_ptr<Shelf> shelf_;
};

}  // namespace tet
