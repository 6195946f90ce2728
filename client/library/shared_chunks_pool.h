// Shared memory that a connection's streams use one after the other.
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "client/library/shared_chunks.h"

namespace tet {

/// Streams of one client that end well leave what they used to the next. Thread-safe.
class SharedChunksPool {
 public:
  /// More than this many at rest are closed.
  static constexpr std::size_t kMost = 4;

  std::unique_ptr<SharedChunks> take() {
    const std::lock_guard lock(mutex_);
    if (resting_.empty()) return std::make_unique<SharedChunks>();
    auto last = std::move(resting_.back());
    resting_.pop_back();
    return last;
  }

  /// Keeps what rests; anything else is closed.
  void give_back(std::unique_ptr<SharedChunks> used) {
    const std::lock_guard lock(mutex_);
    if (used->rests() && resting_.size() < kMost) resting_.push_back(std::move(used));
  }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<SharedChunks>> resting_;
};

/// What one stream uses of a pool, which outlives it.
class PooledSharedChunks {
 public:
  explicit PooledSharedChunks(SharedChunksPool& pool) : pool_(pool), chunks_(pool.take()) {}
  ~PooledSharedChunks() { pool_.give_back(std::move(chunks_)); }
  PooledSharedChunks(const PooledSharedChunks&) = delete;
  PooledSharedChunks& operator=(const PooledSharedChunks&) = delete;

  SharedChunks& operator*() const noexcept { return *chunks_; }
  SharedChunks* operator->() const noexcept { return chunks_.get(); }

 private:
  SharedChunksPool& pool_;
  std::unique_ptr<SharedChunks> chunks_;
};

}  // namespace tet
