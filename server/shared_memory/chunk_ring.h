// Blocks of shared memory that a stream's chunks are made in, again and again.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "server/shared_memory/ring_memory.h"
#include "server/shared_memory/side_connection.h"

namespace tet {

/// How a stream's client hears of its chunks.
enum class ChunkNews : bool {
  kInStream,  ///< in the stream, and it acknowledges each
  kBeside,    ///< through its connection, and what it acknowledges stands for all before
};

/// Chunk i is made in block (i - first) % blocks, once the client has acknowledged the chunk
/// that was there before. A client acknowledges the chunks it was told of, each once and in
/// their order, or several at a time; anything else ends its stream. Thread-safe.
class ChunkRing : public SideUser, public std::enable_shared_from_this<ChunkRing> {
 public:
  using Clock = std::chrono::steady_clock;

  /// What a ring tells its stream, on the port's thread, without a lock.
  struct Events {
    std::function<void()> freed;                     ///< a block
    std::function<void(const absl::Status&)> broke;  ///< the stream ends with this
  };

  /// Hands the memory to the client; chunks from `first` on go into it. Null where the client
  /// does not take it.
  static std::shared_ptr<ChunkRing> open(std::shared_ptr<SideConnection> connection,
                                         std::shared_ptr<RingMemory> memory,
                                         std::uint64_t first,
                                         ChunkNews news,
                                         Events events);

  const RingSize& size() const noexcept { return memory_->size(); }
  ChunkNews news() const noexcept { return news_; }

  /// Whether chunk `index` may be made: what was in its block has been read.
  bool has_room(std::uint64_t index) const;
  /// The offset of a chunk's block.
  std::uint64_t offset_of(std::uint64_t index) const noexcept {
    return (index - first_) % size().blocks * size().block_bytes;
  }
  std::span<std::byte> block_of(std::uint64_t index) const noexcept {
    return memory_->memory().bytes().subspan(static_cast<std::size_t>(offset_of(index)),
                                             size().block_bytes);
  }
  /// The client is about to be told of all chunks before `end`.
  void tell(std::uint64_t end);
  /// Tells it something through its connection. False where it does not take that.
  bool tell_beside(std::span<const std::byte> message) const noexcept {
    return connection_->tell(message);
  }
  /// Since when a chunk that the client was told of waits for its acknowledgement.
  std::optional<Clock::time_point> waiting_since() const;
  /// Whether every chunk that the client was told of is acknowledged.
  bool is_drained() const { return !waiting_since(); }
  /// Listens to the client no more. Returns the memory, which nobody may write to any longer if
  /// others are to have it.
  std::shared_ptr<RingMemory> end() const noexcept;

  void acknowledged(std::uint64_t index) override;
  void ended() override;

 private:
  ChunkRing(std::shared_ptr<SideConnection> connection,
            std::shared_ptr<RingMemory> memory,
            std::uint64_t first,
            ChunkNews news,
            Events events);

  const std::shared_ptr<SideConnection> connection_;
  const std::shared_ptr<RingMemory> memory_;
  const std::uint64_t first_;
  const ChunkNews news_;
  const Events events_;
  mutable std::mutex mutex_;
  std::uint64_t told_, acknowledged_;  ///< one past the last chunk
  Clock::time_point moved_ = Clock::now();
};

}  // namespace tet
