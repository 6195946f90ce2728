#include "client/library/shared_chunks.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <utility>

#include <absl/strings/str_cat.h>
#include <grpcpp/support/slice.h>

#include "client/library/stream_checks.h"
#include "core/base/posix/packet_socket.h"
#include "proto/wire/checksum.h"
#include "proto/wire/shared_columns.h"
#include "proto/wire/side_messages.h"

namespace tet {

namespace {

constexpr std::size_t kTokenBytes = 16;
constexpr std::size_t kTetsColumn = 1;  ///< of ChunkColumns::all
// What was copied is read again from the nearest cache.
constexpr std::size_t kPiece = std::size_t{16} << 10;

/// How long one waits here before one looks whether the stream has ended.
constexpr std::chrono::milliseconds kLook{1000};
/// Answers for each time that all blocks are used: a server has half as many chunks made ahead,
/// and waits for none.
constexpr std::int64_t kAnswersARound = 3;

/// More than any window of chunks.
constexpr std::int64_t kMostBlockBytes = std::int64_t{1} << 30, kMostBlocks = 1 << 16;
constexpr std::int64_t kMostBytes = std::int64_t{1} << 34;

bool is_next_in_stream(std::span<const std::byte> message) {
  return std::ranges::equal(message, kNextIsInStream);
}

/// Copies piece by piece and has each looked at where it lies then, as the memory may change
/// between two looks at it.
template <class Look>
void copy_pieces(std::span<const std::byte> from, std::span<std::byte> to, const Look& look) {
  for (std::size_t begin = 0; begin < to.size(); begin += kPiece) {
    const auto piece = to.subspan(begin, std::min(kPiece, to.size() - begin));
    std::memcpy(piece.data(), from.data() + begin, piece.size());
    look(piece);
  }
}

}  // namespace

std::string SharedChunks::begin(const std::string& grpc_path,
                                const Cancellation& cancellation) {
  pause();
  const bool goes_on = std::exchange(rests_, false) && grpc_path == path_ && is_quiet(side_);
  if (goes_on || connect(grpc_path, cancellation)) return token_;
  side_ = Descriptor();
  return {};
}

bool SharedChunks::connect(const std::string& grpc_path, const Cancellation& cancellation) {
  memory_.reset();
  if (grpc_path.empty() || refused_) return false;
  path_ = grpc_path;
  side_ = connect_for_packets(absl::StrCat(grpc_path, kSideSocketEnding));
  if (!side_.is_open()) return false;
  token_.assign(kTokenBytes, '\0');
  Descriptor none;
  refused_ = !await_packet(side_, std::as_writable_bytes(std::span(token_)),
                           patience(cancellation), none, cancellation.descriptor());
  return !refused_;
}

/// How long a cancellation's deadline lets anyone wait.
std::chrono::milliseconds SharedChunks::patience(const Cancellation& cancellation) const {
  using Duration = Cancellation::Clock::duration;
  const Duration left = cancellation.deadline() - Cancellation::Clock::now();
  return std::chrono::duration_cast<std::chrono::milliseconds>(
      std::clamp(left, Duration::zero(), Duration(patience_)));
}

absl::Status SharedChunks::open(const v1::SharedMemory& told,
                                const Cancellation& cancellation) {
  open_ = false;
  if (!side_.is_open()) return bad_stream("it tells of shared memory that nobody asked for");
  refused_ = true;  // unless it works
  const bool sane = told.blocks() > 0 && told.blocks() <= kMostBlocks &&
                    told.block_bytes() > 0 && told.block_bytes() <= kMostBlockBytes &&
                    told.blocks() * told.block_bytes() <= kMostBytes;
  if (!sane) return bad_stream("impossible sizes of shared memory");
  const auto bytes = static_cast<std::size_t>(told.blocks() * told.block_bytes());
  SideMessage size{};
  Descriptor file;
  const bool came =
      await_packet(side_, size, patience(cancellation), file, cancellation.descriptor());
  if (!came && cancellation.requested()) {
    refused_ = false;  // it would have worked, for all we know
    side_ = Descriptor();
    return check_cancelled(cancellation);
  }
  if (!came || side_number(size) != bytes) {
    return absl::UnavailableError("the server did not hand over its shared memory");
  }
  if (!memory_ || !memory_->is_of(file, bytes)) {
    memory_.reset();
    auto mapped = SharedMemory::map(file, bytes);
    if (!mapped.ok()) {
      return absl::UnavailableError(absl::StrCat("the server's shared memory cannot be used: ",
                                                 mapped.status().message()));
    }
    memory_ = *std::move(mapped);
  }
  refused_ = false;
  open_ = true;
  events_ = next_is_here_ = told.events();
  answer_after_ =
      events_ ? static_cast<std::uint64_t>((told.blocks() + 1) / kAnswersARound) : 1;
  unanswered_ = 0;
  looked_ = answered_ = Clock::now();
  return absl::OkStatus();
}

bool SharedChunks::take_event(grpc::ByteBuffer& event,
                              const Cancellation& cancellation,
                              const InStream& in_stream) {
  std::array<std::byte, kMostSideEventBytes> bytes{};
  while (open_ && next_is_here_ && !cancellation.requested()) {
    std::size_t size = 0;
    const auto wait =
        std::min(unanswered_ > 0 ? answers_within_ : kLook, patience(cancellation));
    Packet packet = await_any_packet(side_, bytes, size, wait, cancellation.descriptor());
    if (is_time_to_look() && in_stream() && packet == Packet::kNone) {
      // What was said here before that comes first.
      packet = take_any_packet(side_, bytes, size);
      if (packet == Packet::kNone) packet = Packet::kEnd;
    }
    if (packet == Packet::kNone) {
      answer();
      continue;
    }
    next_is_here_ =
        packet == Packet::kTaken && !is_next_in_stream(std::span(bytes).first(size));
    if (packet == Packet::kEnd) events_ = false;
    if (next_is_here_) {
      const grpc::Slice slice(bytes.data(), size);
      event = grpc::ByteBuffer(&slice, 1);
      return true;
    }
  }
  answer();
  return false;
}

/// Now and then, whether or not something comes here: it is then that gRPC answers its peer.
bool SharedChunks::is_time_to_look() noexcept {
  const Clock::time_point now = Clock::now();
  const bool is_time = now - looked_ >= kLook;
  if (is_time) looked_ = now;
  return is_time;
}

void SharedChunks::pause() noexcept {
  open_ = events_ = next_is_here_ = false;
  if (memory_ && memory_->holds_pages()) memory_.reset();
}

void SharedChunks::rest() noexcept {
  pause();
  rests_ = side_.is_open() && !refused_;
}

absl::StatusOr<CopiedChunk> SharedChunks::copy(std::int64_t offset,
                                               const ChunkColumns& to,
                                               const MeshHeader& header) const {
  if (!open_) return bad_stream("a chunk in shared memory that nobody has");
  std::array<std::size_t, kMeshColumns> sizes{};
  const auto places = to.all();
  std::ranges::transform(places, sizes.begin(), [](auto column) { return column.size(); });
  const SharedColumns layout(sizes);
  const auto bytes = memory_->bytes();
  if (offset < 0 || static_cast<std::uint64_t>(offset) > bytes.size() ||
      layout.bytes() > bytes.size() - static_cast<std::size_t>(offset)) {
    return bad_stream("a chunk that lies beyond its shared memory");
  }
  CopiedChunk copied;
  const std::byte* const block = bytes.data() + offset;
  for (std::size_t i = 0; i < places.size(); ++i) {
    copy_pieces(layout.column(block, i), places[i], [&](std::span<const std::byte> piece) {
      copied.checksum = add_to_checksum(copied.checksum, piece);
      if (i == kTetsColumn && !ids_are_within(piece, header)) copied.ids_are_within = false;
    });
  }
  return copied;
}

absl::Status SharedChunks::distrust(std::uint64_t index) {
  refused_ = true;
  if (memory_ && memory_->holds_pages()) {
    return bad_stream(absl::StrCat("chunk ", index, " has a wrong checksum"));
  }
  return absl::UnavailableError(
      absl::StrCat("chunk ", index, " is not in shared memory any more"));
}

void SharedChunks::acknowledge(std::uint64_t index) noexcept {
  last_ = index;
  next_is_here_ = events_;
  ++unanswered_;
  if (unanswered_ >= answer_after_ || Clock::now() - answered_ >= answers_within_) answer();
}

/// For all that came.
void SharedChunks::answer() noexcept {
  if (open_ && unanswered_ > 0) send_packet(side_, side_message(last_));
  unanswered_ = 0;
  answered_ = Clock::now();
}

}  // namespace tet
