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

#include "core/base/posix/sealed_memory.h"
#include "server/shared_memory/side_connection.h"

namespace tet {

/// Chunk i is made in block (i - first) % blocks, once the client has acknowledged the chunk
/// that was there before. A client acknowledges the chunks it was told of, each once and in
/// their order; anything else ends its stream. Thread-safe.
class ChunkRing : public SideUser, public std::enable_shared_from_this<ChunkRing> {
 public:
  using Clock = std::chrono::steady_clock;

  struct Size {
    std::uint64_t blocks = 0;
    std::size_t block_bytes = 0;
  };

  /// What a ring tells its stream, on the port's thread, without a lock.
  struct Events {
    std::function<void()> freed;                     ///< a block
    std::function<void(const absl::Status&)> broke;  ///< the stream ends with this
  };

  /// Makes the memory and hands it to the client. `charged` lives as long as the memory does;
  /// chunks from `first` on go into it.
  /// Errors: those of SealedMemory, kUnavailable (the client does not take it).
  static absl::StatusOr<std::shared_ptr<ChunkRing>> open(
      std::shared_ptr<SideConnection> connection,
      Size size,
      std::uint64_t first,
      std::shared_ptr<const void> charged,
      Events events);
  ~ChunkRing() override { close(); }

  const Size& size() const noexcept { return size_; }

  /// Whether chunk `index` may be made: what was in its block has been read.
  bool has_room(std::uint64_t index) const;
  /// The offset of a chunk's block.
  std::uint64_t offset_of(std::uint64_t index) const noexcept {
    return (index - first_) % size_.blocks * size_.block_bytes;
  }
  std::span<std::byte> block_of(std::uint64_t index) const noexcept {
    return memory_.bytes().subspan(static_cast<std::size_t>(offset_of(index)),
                                   size_.block_bytes);
  }
  /// The client is about to be told of all chunks before `end`.
  void tell(std::uint64_t end);
  /// Since when a chunk that the client was told of waits for its acknowledgement.
  std::optional<Clock::time_point> waiting_since() const;
  /// The stream has ended: the client is not listened to any more.
  void close() noexcept { connection_->close(); }

  void acknowledged(std::uint64_t index) override;
  void ended() override;

 private:
  ChunkRing(std::shared_ptr<SideConnection> connection,
            SealedMemory memory,
            Size size,
            std::uint64_t first,
            std::shared_ptr<const void> charged,
            Events events);

  const std::shared_ptr<SideConnection> connection_;
  const std::shared_ptr<const void> charged_;  // goes after the memory
  const SealedMemory memory_;
  const Size size_;
  const std::uint64_t first_;
  const Events events_;
  mutable std::mutex mutex_;
  std::uint64_t told_, acknowledged_;  ///< one past the last chunk
  Clock::time_point moved_ = Clock::now();
};

}  // namespace tet
