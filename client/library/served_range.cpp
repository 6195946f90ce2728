#include "client/library/served_range.h"

#include <utility>

#include <absl/strings/str_cat.h>

#include "client/library/stream_checks.h"
#include "proto/wire/serialized.h"

namespace tet {

ServedRange::ServedRange(std::shared_ptr<Connection> connection,
                         RangeCall call,
                         ClientProgress progress,
                         const Cancellation& cancellation)
    : connection_(std::move(connection)),
      call_(std::move(call)),
      progress_(std::move(progress)),
      events_(*connection_, stream_call(), cancellation) {}

StreamCall ServedRange::stream_call() {
  return {.service = call_.service,
          .method = call_.method,
          .request =
              [this] {
                const std::uint64_t end =
                    receiver_ ? receiver_->end_chunk() : call_.end.value_or(0);
                return call_.request(next_chunk(), end, mesh_id_);
              },
          .take = [this](grpc::ByteBuffer& event) { return take(event); },
          .complete = [this] { return receiver_ && receiver_->complete(); },
          .next_chunk = [this] { return next_chunk(); }};
}

absl::StatusOr<const MeshHeader*> ServedRange::header() {
  while (failure_.ok() && !receiver_) {
    if (const auto more = step(); !more.ok()) return more.status();
  }
  if (!failure_.ok()) return failure_;
  return &header_;
}

absl::StatusOr<const ChunkView*> ServedRange::next() {
  if (const auto counted = header(); !counted.ok()) return counted.status();
  if (receiver_->end_chunk() == call_.first) return nullptr;  // an end of 0 would ask for all
  while (!std::exchange(has_chunk_, false)) {
    const absl::StatusOr<bool> more = step();
    if (!more.ok()) return more.status();
    if (!*more) return nullptr;
  }
  return &chunk_;
}

absl::StatusOr<bool> ServedRange::step() {
  absl::StatusOr<bool> more = events_.step();
  failure_ = more.status();
  return more;
}

absl::Status ServedRange::take(grpc::ByteBuffer& event) {
  if (receiver_) return receiver_->take(event);
  v1::MeshEvent message;
  if (!deserialize(event, message)) return bad_stream("a message that is no MeshEvent");
  if (message.has_header()) return begin(message.header());
  return message.has_chunk() ? bad_stream("a chunk before the header") : absl::OkStatus();
}

absl::Status ServedRange::begin(const v1::MeshHeader& message) {
  absl::StatusOr<MeshHeader> header = checked_header(message);
  if (!header.ok()) return header.status();
  const std::uint64_t end = call_.end.value_or(header->chunk_count);
  if (call_.first > end || end > header->chunk_count) {
    return bad_stream(absl::StrCat("chunks ", call_.first, " to ", end,
                                   " of a mesh that says it has ", header->chunk_count));
  }
  header_ = *std::move(header);
  mesh_id_ = message.mesh_id();
  receiver_.emplace(
      header_, mesh_id_, call_.first, end,
      [this](const TetMesh& part, const ChunkExtent& place) { return show(part, place); });
  return absl::OkStatus();
}

/// The receiver keeps the part until it takes the next.
absl::Status ServedRange::show(const TetMesh& part, const ChunkExtent& place) {
  chunk_ = {receiver_->next_chunk(), place, part.columns()};
  has_chunk_ = true;
  tets_ += place.tet_count;
  if (progress_.tets && header_.tet_count > 0) progress_.tets(tets_, header_.tet_count);
  return absl::OkStatus();
}

}  // namespace tet
