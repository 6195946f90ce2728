#include "server/streams/stream_ring.h"

#include <utility>

#include <absl/strings/str_cat.h>

#include "proto/wire/chunk_frame.h"

namespace tet {

namespace {

constexpr std::size_t kPageBytes = 4096;
/// Columns lie at aligned places, and blocks at pages.
constexpr std::size_t kRingBlockBytes =
    (kChunkBytes + ChunkFrame::kColumns * ChunkFrame::kAlignment + kPageBytes - 1) /
    kPageBytes * kPageBytes;

}  // namespace

absl::StatusOr<std::shared_ptr<ChunkRing>> open_stream_ring(
    MeshEngine& engine,
    const std::string& client,
    std::shared_ptr<SideConnection> connection,
    std::uint64_t blocks,
    std::uint64_t first,
    ChunkRing::Events events) {
  auto charged = engine.send_budget.take(client, blocks * kRingBlockBytes);
  if (charged == nullptr) {
    return absl::ResourceExhaustedError(absl::StrCat(
        "no room for ", blocks * kRingBlockBytes, " bytes of chunks besides those of others"));
  }
  return ChunkRing::open(std::move(connection), {blocks, kRingBlockBytes}, first,
                         std::move(charged), std::move(events));
}

}  // namespace tet
