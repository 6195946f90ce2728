// Shared memory for a stream's chunks, where its client has asked for it.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include <absl/status/status.h>

#include "server/shared_memory/chunk_ring.h"
#include "server/shared_memory/shared_memory_port.h"
#include "server/streams/mesh_engine.h"

namespace tet {

/// A stream's part in shared memory: the connection through which its client is handed it, and
/// the ring of the chunks that are being sent. Its owner's lock guards it.
class StreamRing {
 public:
  explicit StreamRing(MeshEngine& engine) : engine_(engine) {}

  /// The client has asked for shared memory with what it was told, which may be nothing, and to
  /// hear of chunks like that.
  void claim(const std::string& token, ChunkNews news);
  bool is_wanted() const noexcept { return wanted_; }

  /// Hands the client a ring of at least so many blocks for chunks from `first` on: what its
  /// last stream has used, or new memory, which is charged to it first. Errors, after which
  /// chunks go without: kFailedPrecondition (it has not connected for that), kResourceExhausted
  /// (others need what there is for chunks), kUnavailable (it does not take the memory), those
  /// of RingMemory::make.
  absl::Status open(const std::string& client,
                    std::uint64_t blocks,
                    std::uint64_t first,
                    ChunkRing::Events events);
  /// Null where chunks go without.
  const std::shared_ptr<ChunkRing>& ring() const noexcept { return ring_; }
  /// Whether the client hears of chunks through its connection.
  bool tells_beside() const noexcept {
    return ring_ != nullptr && ring_->news() == ChunkNews::kBeside;
  }

  /// Whether chunks that were told of are not yet acknowledged.
  bool is_awaited() const { return ring_ != nullptr && !ring_->is_drained(); }
  /// All chunks were sent and acknowledged: the memory is kept for what comes next.
  void rest();
  /// The stream is over. One that ended well leaves its connection to the client's next.
  void end(bool well);

 private:
  absl::StatusOr<std::shared_ptr<RingMemory>> memory(const std::string& client, RingSize size);

  MeshEngine& engine_;
  SideClaim claim_;
  ChunkNews news_ = ChunkNews::kInStream;
  std::shared_ptr<ChunkRing> ring_;
  bool wanted_ = false, counted_ = false;
};

}  // namespace tet
