#include "client/library/served_chunks.h"

#include <new>
#include <utility>

#include <absl/strings/str_cat.h>

#include "core/plan/make/fill_mesh.h"
#include "proto/wire/serialized.h"
#include "tetstream/v1/meshes.grpc.pb.h"

namespace tet {

ServedChunks::ServedChunks(std::shared_ptr<Connection> connection,
                           v1::StreamMeshRequest request,
                           ClientProgress progress,
                           const Cancellation& cancellation)
    : connection_(std::move(connection)),
      request_(std::move(request)),
      progress_(std::move(progress)),
      cancellation_(cancellation),
      events_(*connection_, call(), cancellation) {
  reader_.use_shared(*shared_, cancellation_);
}

StreamCall ServedChunks::call() {
  return {.service = v1::MeshService::service_full_name(),
          .method = "StreamMesh",
          .request =
              [this] {
                request_.set_start_chunk(static_cast<std::int64_t>(reader_.next_chunk()));
                request_.set_expected_mesh_id(reader_.told().mesh_id);
                shared_->ask(request_, connection_->server().shared_memory_path(),
                             cancellation_);
                return serialized(request_);
              },
          .take = [this](grpc::ByteBuffer& event) { return reader_.take(event); },
          .complete = [this] { return reader_.complete(); },
          .next_chunk = [this] { return reader_.next_chunk(); },
          .shared = &*shared_};
}

absl::StatusOr<const MeshHeader*> ServedChunks::header() {
  while (failure_.ok() && !reader_.has_header()) {
    if (const auto more = step(); !more.ok()) return more.status();
  }
  if (!failure_.ok()) return failure_;
  return &reader_.told().mesh.header;
}

absl::StatusOr<const ChunkView*> ServedChunks::next() {
  if (!failure_.ok()) return failure_;
  while (!std::exchange(has_chunk_, false)) {
    const absl::StatusOr<bool> more = gathered_ ? absl::StatusOr<bool>(false) : step();
    if (!more.ok()) return more.status();
    if (*more) continue;
    if (!reader_.compact()) return note_facts(), nullptr;
    if (!gathered_) failure_ = gather();
    if (!failure_.ok()) return failure_;
    return gathered_chunk();
  }
  return &chunk_;
}

absl::StatusOr<bool> ServedChunks::step() {
  absl::StatusOr<bool> more = events_.step();
  failure_ = more.status();
  if (more.ok() && *more) tell_progress();
  if (more.ok() && !*more) shared_->rest();
  return more;
}

void ServedChunks::tell_progress() {
  if (const auto& planning = reader_.planning()) {
    if (progress_.planning) {
      progress_.planning(static_cast<std::uint64_t>(planning->done_bricks()),
                         static_cast<std::uint64_t>(planning->total_bricks()));
    }
  } else if (progress_.tets) {
    progress_.tets(reader_.tets_received(), reader_.told().mesh.header.tet_count);
  }
}

absl::Status ServedChunks::make_room(const MeshHeader& /*header*/, const KeptParts* /*kept*/) {
  return absl::OkStatus();  // a chunk at a time
}

absl::StatusOr<ChunkColumns> ServedChunks::place(const ChunkExtent& chunk) {
  const MeshHeader& header = reader_.told().mesh.header;
  try {
    return memory_.make(header_of_chunk(header, chunk)).columns();
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError(
        absl::StrCat("no memory for a chunk of ", chunk.tet_count, " tets"));
  }
}

absl::Status ServedChunks::take(const ChunkExtent& chunk) {
  chunk_ = {reader_.next_chunk() - 1, chunk, std::as_const(memory_.mesh()).columns()};
  has_chunk_ = true;
  return absl::OkStatus();
}

/// Makes the whole mesh of its compact chunks.
absl::Status ServedChunks::gather() {
  const MeshHeader& header = reader_.told().mesh.header;
  absl::StatusOr<FilledMesh> filled =
      std::move(*reader_.compact()).finish(header, cancellation_, {}, reader_.statistics());
  if (!filled.ok()) return filled.status();
  gathered_ = std::make_shared<TetMesh>(std::move(filled->mesh));
  note_facts();
  if (reader_.statistics() == Statistics::kMeasured) facts_.quality = filled->quality;
  return absl::OkStatus();
}

/// The next of the chunks that the mesh would have come in; null after the last.
const ChunkView* ServedChunks::gathered_chunk() {
  if (handed_on_ == reader_.compact_chunks().size()) return nullptr;
  const ChunkExtent& place = reader_.compact_chunks()[handed_on_];
  chunk_ = {handed_on_++, place, gathered_->columns_of(place)};
  return &chunk_;
}

void ServedChunks::note_facts() {
  const StreamedMesh& told = reader_.told();
  facts_ = {std::nullopt, told.boundary, told.improvement, told.thin_walls, told.fidelity};
  if (reader_.has_quality() && !told.quality.empty()) facts_.quality = told.quality;
}

}  // namespace tet
