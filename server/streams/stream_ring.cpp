#include "server/streams/stream_ring.h"

#include <utility>

#include <absl/strings/str_cat.h>

#include "proto/wire/chunk_frame.h"

namespace tet {

namespace {

constexpr std::size_t kPageBytes = 4096;
/// So many messages fit into a connection that nobody reads, with all that the system counts
/// for each.
constexpr std::uint64_t kMostBeside = 128;
/// Columns lie at aligned places, and blocks at pages.
constexpr std::size_t kRingBlockBytes =
    (kChunkBytes + ChunkFrame::kColumns * ChunkFrame::kAlignment + kPageBytes - 1) /
    kPageBytes * kPageBytes;

}  // namespace

void StreamRing::claim(const std::string& token, ChunkNews news) {
  wanted_ = !token.empty();
  news_ = news;
  if (wanted_ && engine_.shared_memory != nullptr) claim_ = engine_.shared_memory->claim(token);
}

absl::Status StreamRing::open(const std::string& client,
                              std::uint64_t blocks,
                              std::uint64_t first,
                              ChunkRing::Events events) {
  if (claim_.connection() == nullptr) {
    return absl::FailedPreconditionError("nobody with this token has connected for it");
  }
  auto taken = memory(client, {blocks, kRingBlockBytes});
  if (!taken.ok()) return taken.status();
  const ChunkNews news = (*taken)->size().blocks > kMostBeside ? ChunkNews::kInStream : news_;
  ring_ =
      ChunkRing::open(claim_.connection(), *std::move(taken), first, news, std::move(events));
  if (ring_ == nullptr) {
    return absl::UnavailableError("the client does not take shared memory");
  }
  if (!std::exchange(counted_, true)) engine_.activity.shared_streams.fetch_add(1);
  return absl::OkStatus();
}

absl::StatusOr<std::shared_ptr<RingMemory>> StreamRing::memory(const std::string& client,
                                                               RingSize size) {
  if (auto kept = engine_.kept_memory.take(claim_.connection(), client, size)) return kept;
  auto charged = engine_.send_budget.take(client, size.bytes());
  if (charged == nullptr) {
    return absl::ResourceExhaustedError(
        absl::StrCat("no room for ", size.bytes(), " bytes of chunks besides those of others"));
  }
  return RingMemory::make(size, claim_.readers(), client, std::move(charged));
}

void StreamRing::rest() {
  if (ring_ == nullptr) return;
  engine_.kept_memory.keep(claim_.connection(), ring_->end());
  ring_ = nullptr;
}

void StreamRing::end(bool well) {
  if (ring_ != nullptr) ring_->end();
  ring_ = nullptr;
  if (well) claim_.give_back();
  claim_.end();
}

}  // namespace tet
