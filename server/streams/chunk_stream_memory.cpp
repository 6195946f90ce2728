// What a stream of chunks does about memory that it shares with its client.
#include <algorithm>
#include <span>
#include <string>
#include <utility>

#include <grpcpp/support/slice.h>

#include "proto/convert/status.h"
#include "proto/wire/side_messages.h"
#include "server/meshing/shared_chunk.h"
#include "server/streams/chunk_stream.h"

namespace tet {

namespace {

/// Blocks of shared memory for each chunk that is made ahead.
constexpr std::uint64_t kRingWindows = 2;

/// It has room for a message about each block that it was told of.
absl::Status does_not_listen() {
  return with_reason(absl::CancelledError(
                         "the client does not take what the socket of its shared memory says"),
                     "CANCELLED");
}

}  // namespace

void ChunkStream::claim_memory(const std::string& token, bool events) {
  const std::lock_guard lock(mutex_);
  if (!ended()) shared_.claim(token, events ? ChunkNews::kBeside : ChunkNews::kInStream);
}

/// A stream that has no shared memory is any other; the log says why.
void ChunkStream::open_ring() {
  if (!shared_.is_wanted()) return;
  // A client acknowledges chunks a little later than gRPC takes messages: threads do not wait.
  const auto window = static_cast<std::uint64_t>(engine_.pool.threads()) + 1;
  const std::uint64_t blocks = std::min(end_ - next_, kRingWindows * window) + 1;
  absl::Status opened = check_shareable();
  if (opened.ok()) opened = shared_.open(call_.client(), blocks, next_, ring_events());
  call_.note("shared_memory", opened.ok());
  if (!opened.ok()) call_.note("shared_memory_why", std::string(opened.message()));
}

absl::StatusOr<ChunkMessage> ChunkStream::make_mesh_chunk(const ChunkSource& source,
                                                          std::uint64_t index,
                                                          Block block) {
  absl::StatusOr<ChunkMessage> made =
      block.ring != nullptr ? make_shared_chunk(source, index, engine_.chunk_memory(),
                                                *block.ring, watch_->cancellation)
                            : make_chunk(source, index, engine_.chunk_memory(),
                                         std::move(block.lease), watch_->cancellation);
  if (made.ok()) engine_.activity.chunks_made.fetch_add(1);
  return made;
}

ChunkRing::Events ChunkStream::ring_events() {
  const std::weak_ptr<ChunkStream> weak = self();
  return {[weak] {
            if (const auto stream = weak.lock()) stream->post_freed();
          },
          [weak](const absl::Status& why) {
            if (const auto stream = weak.lock()) stream->break_off(why);
          }};
}

/// Tells of all chunks that are ready, without gRPC and its threads. What comes next is in the
/// stream again: the trailer, the end, or a chunk that is in no block.
void ChunkStream::tell_beside() {
  while (phase_ == Phase::kChunks && slot_of(next_).ready) {
    if (!tell_of_chunk()) return;
  }
  if (phase_ == Phase::kChunks) return;
  tell_of_rest();
  waits_ = phase_ == Phase::kSent;  // for the acknowledgements, of which the last is to come
}

/// Behind the last chunk: the rest is in the stream.
void ChunkStream::tell_of_rest() {
  if (!shared_.ring()->tell_beside(kNextIsInStream)) end(does_not_listen());
}

/// False where the chunk is to be written to the stream, and after an end.
bool ChunkStream::tell_of_chunk() {
  grpc::ByteBuffer& event = slot_of(next_).made.event;
  grpc::Slice bytes;
  const bool fits =
      event.Length() <= kMostSideEventBytes && event.DumpToSingleSlice(&bytes).ok();
  const ChunkRing& ring = *shared_.ring();
  if (fits) shared_.ring()->tell(next_ + 1);
  const auto message = fits ? std::as_bytes(std::span(bytes.begin(), bytes.size()))
                            : std::span<const std::byte>(kNextIsInStream);
  if (!ring.tell_beside(message)) {
    end(does_not_listen());
    return false;
  }
  if (!fits) return false;
  event.Clear();
  after_chunk();
  phase_ = phase_of_next();
  return true;
}

/// A block of the ring is free.
void ChunkStream::post_freed() {
  bool all = false;
  {
    const std::lock_guard lock(mutex_);
    if (ended()) return;
    post_chunks();
    all = std::exchange(waits_, false) && all_acknowledged();
  }
  if (all) guard([this] { sent_all(); });
  advance();
}

/// Once all is sent. What was acknowledged may be overwritten, by whatever comes next.
bool ChunkStream::all_acknowledged() {
  waits_ = shared_.is_awaited();
  if (!waits_) shared_.rest();
  return !waits_;
}

/// A reader of shared memory stops the stream by not acknowledging what it was told of.
std::optional<Stallable::Clock::time_point> ChunkStream::waiting_since() {
  if (const auto writing = StreamWriter::waiting_since()) return writing;
  const std::lock_guard lock(mutex_);
  return shared_.ring() == nullptr || ended() ? std::nullopt : shared_.ring()->waiting_since();
}

void ChunkStream::give_up(std::chrono::seconds waited) {
  const bool writing = StreamWriter::waiting_since().has_value();
  if (writing || !waiting_since()) return StreamWriter::give_up(waited);
  break_off(client_stalled("acknowledged no chunk", waited));
}

}  // namespace tet
