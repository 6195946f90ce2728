#include "client/library/stream_reader.h"

#include <algorithm>
#include <span>
#include <string>
#include <utility>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "client/library/check_labels.h"
#include "client/library/chunk_message.h"
#include "client/library/error_details.h"
#include "client/library/stream_checks.h"
#include "core/mesh/check_faces.h"
#include "proto/convert/chunk_numbers.h"
#include "proto/convert/counts.h"
#include "proto/convert/fidelity.h"
#include "proto/convert/mesh_parts.h"
#include "proto/convert/statistics.h"
#include "proto/wire/checksum.h"
#include "proto/wire/serialized.h"

namespace tet {

namespace {

/// What the server said in a message that cannot be.
absl::Status bad_part(const char* what, const absl::Status& status) {
  return bad_stream(absl::StrFormat("%s: %s", what, status.message()));
}

absl::Status verify_checksum(const ChunkNumbers& chunk, std::uint32_t checksum) {
  if (checksum == chunk.checksum) return absl::OkStatus();
  return bad_stream(absl::StrCat("chunk ", chunk.index, " has a wrong checksum"));
}

/// True when all from `begin` to `end` is kept.
bool is_kept(const std::vector<KeptRun>& runs, std::uint64_t begin, std::uint64_t end) {
  while (begin < end) {
    const auto after = std::upper_bound(
        runs.begin(), runs.end(), begin,
        [](std::uint64_t value, const KeptRun& run) { return value < run.to; });
    if (after == runs.begin()) return false;
    const KeptRun& run = *(after - 1);
    if (begin - run.to >= run.count) return false;
    begin = run.to + run.count;
  }
  return true;
}

std::uint64_t total_of(const std::vector<KeptRun>& runs) {
  std::uint64_t count = 0;
  for (const KeptRun& run : runs) count += run.count;
  return count;
}

}  // namespace

absl::Status StreamReader::take(grpc::ByteBuffer& event) {
  const std::uint64_t chunk = next_chunk_;
  absl::Status taken = read(event);
  // Also one that is not in shared memory: the server counts them all.
  if (taken.ok() && shared_ != nullptr && next_chunk_ > chunk) shared_->acknowledge(chunk);
  return taken;
}

absl::Status StreamReader::read(grpc::ByteBuffer& event) {
  if (const auto chunk = compact_ ? std::nullopt : read_chunk(event)) {
    planning_.reset();
    const auto columns = place_of(chunk->numbers, sizes_of(*chunk));
    if (!columns.ok()) return columns.status();
    const std::uint32_t checksum = copy_columns(event, *chunk, *columns);
    return advance(chunk->numbers, *columns,
                   {checksum, ids_are_within(columns->tets, header())});
  }
  v1::MeshEvent message;
  if (!deserialize(event, message)) {
    return bad_stream("a message that is no MeshEvent");
  }
  return take(message);
}

absl::Status StreamReader::take(const v1::MeshEvent& event) {
  planning_.reset();
  switch (event.event_case()) {
    case v1::MeshEvent::kHeader:
      return take_header(event.header());
    case v1::MeshEvent::kChunk:
      return take_chunk(event.chunk());
    case v1::MeshEvent::kTrailer:
      return take_trailer(event.trailer());
    case v1::MeshEvent::kRefused:
      return take_refusal(event.refused());
    case v1::MeshEvent::kProgress:
      planning_ = event.progress();
      return absl::OkStatus();
    default:
      return absl::OkStatus();  // news from a newer server
  }
}

absl::Status StreamReader::take_header(const v1::MeshHeader& header) {
  const absl::StatusOr<MeshHeader> checked = checked_header(header);
  if (!checked.ok()) return checked.status();
  told_.cached = header.cached();
  told_.shared_memory = header.has_shared_memory();
  if (header.has_shared_memory()) {
    if (shared_ == nullptr)
      return bad_stream("it tells of shared memory that nobody asked for");
    const absl::Status opened = shared_->open(header.shared_memory(), *cancellation_);
    if (!opened.ok()) return opened;
  }
  if (has_header_) return resume(header);
  if (absl::Status status = begin(header, *checked); !status.ok()) return status;
  told_.mesh.header = *checked;
  chunks_ =
      unsigned_count(header.has_kept() ? header.kept().patch_count() : header.chunk_count());
  keeps_parts_ = header.has_kept();
  told_.mesh_id = header.mesh_id();
  told_.canonical_request = header.canonical_request();
  has_header_ = true;
  return absl::OkStatus();
}

/// Takes the header of a resumed stream, of the same mesh in the same chunks. The server may
/// have the base at one attempt and not at the other: then chunk 3 is another one, and all has
/// to come anew.
absl::Status StreamReader::resume(const v1::MeshHeader& header) {
  const bool same_chunks = header.has_kept() == keeps_parts_;
  if (header.mesh_id() != told_.mesh_id || (!same_chunks && base_ != Base::kNamed)) {
    return bad_stream("another mesh after resuming");
  }
  if (same_chunks) return absl::OkStatus();
  StreamReader anew(*consumer_, base_);
  anew.shared_ = shared_;
  anew.cancellation_ = cancellation_;
  anew.told_.mesh_id = std::move(told_.mesh_id);  // which is still what is asked for
  *this = std::move(anew);
  return absl::UnavailableError(
      "the server has the mesh to be updated at one attempt and not at the other");
}

absl::Status StreamReader::begin(const v1::MeshHeader& header, const MeshHeader& checked) {
  if (header.has_lattice()) {
    absl::StatusOr<CompactReceiver> compact = CompactReceiver::begin(header);
    if (!compact.ok()) return compact.status();
    compact_ = *std::move(compact);
    return absl::OkStatus();
  }
  if (!header.has_kept()) return consumer_->make_room(checked, nullptr);
  if (base_ == Base::kNone)
    return bad_stream("it keeps parts of a mesh that the request does not name");
  if (checked.has_faces()) return bad_stream("it keeps parts of a mesh with faces");
  if (!is_count(header.kept().patch_count())) return bad_stream("an impossible patch_count");
  absl::StatusOr<KeptParts> kept = from_proto(header.kept());
  if (!kept.ok()) return bad_part("kept parts", kept.status());
  if (kept->loose && base_ != Base::kFrame) return bad_stream("loose patches for no frame");
  kept_ = *std::move(kept);
  absl::Status status = consumer_->make_room(checked, &kept_);
  if (!status.ok()) {
    return absl::IsInvalidArgument(status) ? bad_stream(status.ToString()) : status;
  }
  // Runs fit, as there is room for them.
  to_come_.vertex_count = checked.vertex_count - total_of(kept_.vertices);
  to_come_.tet_count = checked.tet_count - total_of(kept_.tets);
  return absl::OkStatus();
}

absl::Status StreamReader::take_chunk(const v1::MeshChunk& chunk) {
  const ChunkNumbers numbers = from_proto(chunk);
  if (compact_) return take_compact(numbers, std::as_bytes(std::span(chunk.compact())));
  if (!chunk.packed().empty()) {
    return take_packed(numbers, std::as_bytes(std::span(chunk.packed())));
  }
  if (chunk.has_shared_offset()) return take_shared(numbers, chunk.shared_offset());
  const auto received = columns_of(chunk);
  const auto columns = place_of(numbers, sizes_of(received));
  if (!columns.ok()) return columns.status();
  copy_columns(received, *columns);
  return advance(numbers, *columns,
                 {chunk_checksum(received), ids_are_within(columns->tets, header())});
}

absl::Status StreamReader::take_shared(const ChunkNumbers& numbers, std::int64_t offset) {
  if (shared_ == nullptr) return bad_stream("a chunk in shared memory that nobody asked for");
  if (absl::Status status = check_place(numbers); !status.ok()) return status;
  const auto columns = consumer_->place(extent_of(numbers));
  if (!columns.ok()) return columns.status();
  const auto copied = shared_->copy(offset, *columns, header());
  if (!copied.ok()) return copied.status();
  if (copied->checksum != numbers.checksum) return shared_->distrust(numbers.index);
  return advance(numbers, *columns, *copied);
}

absl::Status StreamReader::take_packed(const ChunkNumbers& numbers,
                                       std::span<const std::byte> bytes) {
  // Its corners are numbers of the chunk's own vertices.
  if (kept_.loose) return bad_stream("a packed chunk among loose patches");
  absl::Status status = check_place(numbers);
  if (status.ok()) status = verify_checksum(numbers, add_to_checksum(0, bytes));
  if (!status.ok()) return status;
  const ChunkExtent extent = extent_of(numbers);
  const auto columns = consumer_->place(extent);
  if (!columns.ok()) return columns.status();
  status = unpacker_.unpack(bytes, header(), extent, *columns);
  return status.ok() ? hand_on(numbers) : bad_stream(std::string(status.message()));
}

absl::Status StreamReader::take_compact(const ChunkNumbers& numbers,
                                        std::span<const std::byte> bytes) {
  absl::Status status = check_place(numbers);
  if (status.ok()) status = verify_checksum(numbers, add_to_checksum(0, bytes));
  if (status.ok()) status = compact_->add(bytes);
  if (!status.ok()) return status;
  compact_chunks_.push_back(extent_of(numbers));
  count(numbers);
  return absl::OkStatus();
}

/// Where the next chunk's columns belong, if this is the next chunk and has columns of that
/// size.
absl::StatusOr<ChunkColumns> StreamReader::place_of(const ChunkNumbers& chunk,
                                                    const ColumnBytes& column_bytes) {
  if (absl::Status status = check_place(chunk); !status.ok()) return status;
  if (column_bytes != ChunkSizes(header(), extent_of(chunk)).all()) {
    return bad_stream(absl::StrCat("chunk ", chunk.index, " has columns of a wrong size"));
  }
  return consumer_->place(extent_of(chunk));
}

/// Whether this is the chunk that is missing next, and fits.
absl::Status StreamReader::check_place(const ChunkNumbers& chunk) const {
  if (!has_header_) return bad_stream("a chunk before the header");
  if (!is_count(chunk.vertex_count) || !is_count(chunk.tet_count) ||
      !is_count(chunk.face_count)) {
    return bad_stream("a chunk with impossible counts");
  }
  const std::uint64_t vertices = kept_.loose ? to_come_.vertex_count : header().vertex_count;
  const std::uint64_t tets = kept_.loose ? to_come_.tet_count : header().tet_count;
  if (!follows(chunk) || chunk.first_vertex > vertices || chunk.first_tet > tets ||
      chunk.vertex_count > vertices - chunk.first_vertex ||
      chunk.tet_count > tets - chunk.first_tet ||
      chunk.face_count > header().face_count - next_face_) {
    return bad_stream(absl::StrCat("chunk ", chunk.index, " is out of place"));
  }
  return absl::OkStatus();
}

/// Whether a chunk begins where the one before it ended, or what is kept behind that.
bool StreamReader::follows(const ChunkNumbers& chunk) const {
  if (chunk.index != next_chunk_ || chunk.first_face != next_face_) return false;
  if (kept_.loose) return chunk.first_vertex == next_vertex_ && chunk.first_tet == next_tet_;
  return chunk.first_vertex >= next_vertex_ && chunk.first_tet >= next_tet_ &&
         is_kept(kept_.vertices, next_vertex_, chunk.first_vertex) &&
         is_kept(kept_.tets, next_tet_, chunk.first_tet);
}

/// Whether nothing is missing any more.
bool StreamReader::is_whole() const {
  if (next_chunk_ != chunks_ || next_face_ != header().face_count) return false;
  if (kept_.loose) {
    return next_vertex_ == to_come_.vertex_count && next_tet_ == to_come_.tet_count;
  }
  return is_kept(kept_.vertices, next_vertex_, header().vertex_count) &&
         is_kept(kept_.tets, next_tet_, header().tet_count);
}

/// A chunk whose columns were copied counts if they are what the server sent; else the next
/// attempt overwrites it.
absl::Status StreamReader::advance(const ChunkNumbers& chunk,
                                   const ChunkColumns& columns,
                                   const CopiedChunk& copied) {
  if (auto status = verify_checksum(chunk, copied.checksum); !status.ok()) return status;
  if (!copied.ids_are_within) {
    return bad_stream(
        absl::StrCat("chunk ", chunk.index, " refers to vertices that do not exist"));
  }
  if (!labels_are_within(columns.regions, header())) {
    return bad_stream(absl::StrCat("chunk ", chunk.index, " has labels that do not exist"));
  }
  if (!faces_are_of_tets(header(), extent_of(chunk), columns)) {
    return bad_stream(
        absl::StrCat("chunk ", chunk.index, " has faces that are not of its tets"));
  }
  return hand_on(chunk);
}

/// It counts first: a consumer that takes no more has this one.
absl::Status StreamReader::hand_on(const ChunkNumbers& chunk) {
  count(chunk);
  return consumer_->take(extent_of(chunk));
}

void StreamReader::count(const ChunkNumbers& chunk) {
  next_vertex_ = chunk.first_vertex + chunk.vertex_count;
  next_tet_ = chunk.first_tet + chunk.tet_count;
  next_face_ = chunk.first_face + chunk.face_count;
  tets_sent_ += chunk.tet_count;
  ++next_chunk_;
}

absl::Status StreamReader::take_refusal(const v1::FrameRefusal& refusal) {
  if (has_header_) return bad_stream("a mesh that was begun and is refused");
  refusal_ = to_absl(refusal);
  return refusal_.ok() ? bad_stream("a refusal that says nothing") : absl::OkStatus();
}

absl::Status StreamReader::take_trailer(const v1::MeshTrailer& trailer) {
  if (!has_header_ || !is_whole()) {
    return bad_stream("it ended before the mesh was whole");
  }
  if (auto status = take_statistics(trailer); !status.ok()) return status;
  complete_ = true;
  return absl::OkStatus();
}

absl::Status StreamReader::take_statistics(const v1::MeshTrailer& trailer) {
  if (trailer.has_boundary()) {
    const auto boundary = from_proto(trailer.boundary());
    if (!boundary.ok()) return bad_part("boundary", boundary.status());
    told_.boundary = *boundary;
  }
  if (trailer.has_improvement()) {
    const auto improvement = from_proto(trailer.improvement());
    if (!improvement.ok()) return bad_part("improvement", improvement.status());
    told_.improvement = *improvement;
  }
  absl::StatusOr<ThinWalls> walls = from_proto(trailer.thin_walls());
  if (!walls.ok()) return bad_part("thin walls", walls.status());
  told_.thin_walls = *std::move(walls);
  auto fidelity = fidelity_of(trailer);
  if (!fidelity.ok()) return bad_part("fidelity", fidelity.status());
  told_.fidelity = *std::move(fidelity);
  return take_quality(trailer);
}

/// The quality of some chunks only is no use: the mesh is measured here then.
absl::Status StreamReader::take_quality(const v1::MeshTrailer& trailer) {
  has_quality_ = trailer.has_quality() && trailer.first_chunk() == 0 &&
                 unsigned_count(trailer.end_chunk()) == chunks_;
  if (!has_quality_) return absl::OkStatus();
  const auto quality = from_proto(trailer.quality());
  if (!quality.ok()) return bad_part("quality", quality.status());
  told_.quality = *quality;
  return absl::OkStatus();
}

Statistics StreamReader::statistics() const noexcept {
  return told_.canonical_request.skip_statistics() ? Statistics::kSkipped
                                                   : Statistics::kMeasured;
}

}  // namespace tet
