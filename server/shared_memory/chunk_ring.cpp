#include "server/shared_memory/chunk_ring.h"

#include <utility>

#include <absl/strings/str_cat.h>

#include "proto/convert/status.h"

namespace tet {

absl::StatusOr<std::shared_ptr<ChunkRing>> ChunkRing::open(
    std::shared_ptr<SideConnection> connection,
    Size size,
    std::uint64_t first,
    std::shared_ptr<const void> charged,
    Events events) {
  auto memory = SealedMemory::make(static_cast<std::size_t>(size.blocks) * size.block_bytes);
  if (!memory.ok()) return memory.status();
  const std::shared_ptr<ChunkRing> ring(new ChunkRing(std::move(connection), *std::move(memory),
                                                      size, first, std::move(charged),
                                                      std::move(events)));
  if (ring->connection_->hand_over(ring->memory_, ring)) return ring;
  return absl::UnavailableError("the client does not take shared memory");
}

ChunkRing::ChunkRing(std::shared_ptr<SideConnection> connection,
                     SealedMemory memory,
                     Size size,
                     std::uint64_t first,
                     std::shared_ptr<const void> charged,
                     Events events)
    : connection_(std::move(connection)),
      charged_(std::move(charged)),
      memory_(std::move(memory)),
      size_(size),
      first_(first),
      events_(std::move(events)),
      told_(first),
      acknowledged_(first) {}

bool ChunkRing::has_room(std::uint64_t index) const {
  const std::lock_guard lock(mutex_);
  return index < acknowledged_ + size_.blocks;
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
    is_next = index == acknowledged_ && index < told_;
    if (is_next) ++acknowledged_;
    moved_ = Clock::now();
  }
  if (is_next) return events_.freed();
  events_.broke(with_reason(absl::InvalidArgumentError(absl::StrCat(
                                "the client acknowledged chunk ", index, ", and not chunk ",
                                expected, ", which it was told of or is to be told of next")),
                            "MESSAGE_ORDER"));
}

void ChunkRing::ended() {
  events_.broke(with_reason(
      absl::CancelledError("the client closed the socket of its shared memory"), "CANCELLED"));
}

}  // namespace tet
