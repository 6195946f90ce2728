#include "server/shared_memory/chunk_ring.h"

#include <utility>

#include <absl/strings/str_cat.h>

#include "proto/convert/status.h"

namespace tet {

std::shared_ptr<ChunkRing> ChunkRing::open(std::shared_ptr<SideConnection> connection,
                                           std::shared_ptr<RingMemory> memory,
                                           std::uint64_t first,
                                           ChunkNews news,
                                           Events events) {
  const std::shared_ptr<ChunkRing> ring(
      new ChunkRing(std::move(connection), std::move(memory), first, news, std::move(events)));
  return ring->connection_->hand_over(ring->memory_->memory(), ring) ? ring : nullptr;
}

ChunkRing::ChunkRing(std::shared_ptr<SideConnection> connection,
                     std::shared_ptr<RingMemory> memory,
                     std::uint64_t first,
                     ChunkNews news,
                     Events events)
    : connection_(std::move(connection)),
      memory_(std::move(memory)),
      first_(first),
      news_(news),
      events_(std::move(events)),
      told_(first),
      acknowledged_(first) {}

std::shared_ptr<RingMemory> ChunkRing::end() const noexcept {
  connection_->take_back();
  return memory_;
}

bool ChunkRing::has_room(std::uint64_t index) const {
  const std::lock_guard lock(mutex_);
  return index < acknowledged_ + size().blocks;
}

void ChunkRing::tell(std::uint64_t end) {
  const std::lock_guard lock(mutex_);
  if (told_ == acknowledged_) moved_ = Clock::now();
  told_ = end;
}

std::optional<ChunkRing::Clock::time_point> ChunkRing::waiting_since() const {
  const std::lock_guard lock(mutex_);
  return told_ == acknowledged_ ? std::nullopt : std::optional(moved_);
}

void ChunkRing::acknowledged(std::uint64_t index) {
  std::uint64_t expected = 0;
  bool is_next = false;
  {
    const std::lock_guard lock(mutex_);
    expected = acknowledged_;
    const bool may_be =
        index == acknowledged_ || (index > acknowledged_ && news_ == ChunkNews::kBeside);
    is_next = may_be && index < told_;
    if (is_next) acknowledged_ = index + 1;
    moved_ = Clock::now();
  }
  if (is_next) return events_.freed();
  events_.broke(with_reason(absl::InvalidArgumentError(absl::StrCat(
                                "the client acknowledged chunk ", index, ", and not chunk ",
                                expected, ", which it was told of or is to be told of next",
                                news_ == ChunkNews::kBeside ? ", or one after that" : "")),
                            "MESSAGE_ORDER"));
}

void ChunkRing::ended() {
  events_.broke(with_reason(
      absl::CancelledError("the client closed the socket of its shared memory"), "CANCELLED"));
}

}  // namespace tet
