#include "client/library/mesh_receiver.h"

#include <algorithm>
#include <cstring>
#include <new>
#include <span>
#include <string>
#include <utility>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "client/library/chunk_message.h"
#include "client/library/stream_checks.h"
#include "core/base/parallel.h"
#include "proto/convert/chunk_numbers.h"
#include "proto/convert/counts.h"
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

ChunkExtent extent_of(const ChunkNumbers& chunk) {
  return {chunk.first_vertex, chunk.vertex_count, chunk.first_tet, chunk.tet_count};
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

}  // namespace

absl::Status MeshReceiver::take(grpc::ByteBuffer& event) {
  if (const auto chunk = compact_ ? std::nullopt : read_chunk(event)) {
    planning_.reset();
    const auto& [positions, tets, regions, fields] = chunk->columns;
    const auto columns =
        place_of(chunk->numbers, {positions.size, tets.size, regions.size, fields.size});
    if (!columns.ok()) return columns.status();
    return advance(chunk->numbers, copy_columns(event, *chunk, *columns));
  }
  v1::MeshEvent message;
  if (!deserialize(event, message)) {
    return bad_stream("a message that is no MeshEvent");
  }
  return take(message);
}

absl::Status MeshReceiver::take(const v1::MeshEvent& event) {
  planning_.reset();
  switch (event.event_case()) {
    case v1::MeshEvent::kHeader:
      return take_header(event.header());
    case v1::MeshEvent::kChunk:
      return take_chunk(event.chunk());
    case v1::MeshEvent::kTrailer:
      return take_trailer(event.trailer());
    case v1::MeshEvent::kProgress:
      planning_ = event.progress();
      return absl::OkStatus();
    default:
      return absl::OkStatus();  // news from a newer server
  }
}

absl::Status MeshReceiver::take_header(const v1::MeshHeader& header) {
  const absl::StatusOr<MeshHeader> checked = checked_header(header);
  if (!checked.ok()) return checked.status();
  received_.cached = header.cached();
  if (has_header_) {
    const bool same =
        header.mesh_id() == received_.mesh_id && header.has_kept() == keeps_parts_;
    return same ? absl::OkStatus() : bad_stream("another mesh after resuming");
  }
  if (header.has_lattice()) {
    absl::StatusOr<CompactReceiver> compact = CompactReceiver::begin(header);
    if (!compact.ok()) return compact.status();
    compact_ = *std::move(compact);
    received_.mesh.header = *checked;  // its columns come last
  } else {
    absl::Status status = header.has_kept() ? take_kept(header, *checked) : allocate(*checked);
    if (!status.ok()) return status;
  }
  chunks_ =
      unsigned_count(header.has_kept() ? header.kept().patch_count() : header.chunk_count());
  keeps_parts_ = header.has_kept();
  received_.mesh_id = header.mesh_id();
  received_.canonical_request = header.canonical_request();
  has_header_ = true;
  return absl::OkStatus();
}

absl::Status MeshReceiver::allocate(const MeshHeader& header) {
  try {
    received_.mesh = TetMesh(header, std::move(used_));
    return absl::OkStatus();
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError(absl::StrCat(
        "no memory for ", header.vertex_count, " vertices and ", header.tet_count, " tets"));
  }
}

absl::Status MeshReceiver::take_kept(const v1::MeshHeader& header, const MeshHeader& checked) {
  if (base_ == nullptr)
    return bad_stream("it keeps parts of a mesh that the request does not name");
  if (!is_count(header.kept().patch_count())) return bad_stream("an impossible patch_count");
  absl::StatusOr<KeptParts> kept = from_proto(header.kept());
  if (!kept.ok()) return bad_part("kept parts", kept.status());
  kept_ = *std::move(kept);
  absl::StatusOr<TetMesh> mesh = absl::InternalError("not made");
  TaskPool pool;
  pool.run([&] { mesh = splice_mesh(*base_, checked, kept_, std::move(used_)); });
  if (absl::IsInvalidArgument(mesh.status())) return bad_stream(mesh.status().ToString());
  if (!mesh.ok()) return mesh.status();
  received_.mesh = *std::move(mesh);
  return absl::OkStatus();
}

absl::Status MeshReceiver::take_chunk(const v1::MeshChunk& chunk) {
  if (compact_ || !chunk.packed().empty()) return take_encoded(chunk);
  const ChunkNumbers numbers = from_proto(chunk);
  const auto columns = place_of(numbers, {chunk.positions().size(), chunk.tets().size(),
                                          chunk.regions().size(), chunk.fields().size()});
  if (!columns.ok()) return columns.status();
  copy_column(chunk.positions(), columns->positions);
  copy_column(chunk.tets(), columns->tets);
  copy_column(chunk.regions(), columns->regions);
  copy_column(chunk.fields(), columns->fields);
  return advance(numbers, chunk_checksum({chunk.positions(), chunk.tets(), chunk.regions(),
                                          chunk.fields()}));
}

/// A chunk with other bytes instead of its columns.
absl::Status MeshReceiver::take_encoded(const v1::MeshChunk& chunk) {
  const ChunkNumbers numbers = from_proto(chunk);
  const auto bytes = std::as_bytes(std::span(compact_ ? chunk.compact() : chunk.packed()));
  absl::Status status = check_place(numbers);
  if (status.ok()) status = verify_checksum(numbers, add_to_checksum(0, bytes));
  if (status.ok()) status = compact_ ? compact_->add(bytes) : unpack(extent_of(numbers), bytes);
  if (status.ok()) count(numbers);
  return status;
}

absl::Status MeshReceiver::unpack(const ChunkExtent& extent, std::span<const std::byte> bytes) {
  const absl::Status status =
      unpacker_.unpack(bytes, received_.mesh.header, extent, received_.mesh.columns_of(extent));
  return status.ok() ? status : bad_stream(std::string(status.message()));
}

/// Where the next chunk's columns belong, if this is the next chunk and has columns of that
/// size.
absl::StatusOr<ChunkColumns> MeshReceiver::place_of(const ChunkNumbers& chunk,
                                                    const ColumnBytes& column_bytes) {
  if (absl::Status status = check_place(chunk); !status.ok()) return status;
  const ChunkColumns columns = received_.mesh.columns_of(extent_of(chunk));
  if (column_bytes[0] != columns.positions.size() || column_bytes[1] != columns.tets.size() ||
      column_bytes[2] != columns.regions.size() || column_bytes[3] != columns.fields.size()) {
    return bad_stream(absl::StrCat("chunk ", chunk.index, " has columns of a wrong size"));
  }
  return columns;
}

/// Whether this is the chunk that is missing next, and fits.
absl::Status MeshReceiver::check_place(const ChunkNumbers& chunk) const {
  if (!has_header_) return bad_stream("a chunk before the header");
  if (!is_count(chunk.vertex_count) || !is_count(chunk.tet_count)) {
    return bad_stream("a chunk with impossible counts");
  }
  const MeshHeader& header = received_.mesh.header;
  const bool follows = chunk.index == next_chunk_ && chunk.first_vertex >= next_vertex_ &&
                       chunk.first_tet >= next_tet_ &&
                       is_kept(kept_.vertices, next_vertex_, chunk.first_vertex) &&
                       is_kept(kept_.tets, next_tet_, chunk.first_tet);
  if (!follows || chunk.first_vertex > header.vertex_count ||
      chunk.first_tet > header.tet_count ||
      chunk.vertex_count > header.vertex_count - chunk.first_vertex ||
      chunk.tet_count > header.tet_count - chunk.first_tet) {
    return bad_stream(absl::StrCat("chunk ", chunk.index, " is out of place"));
  }
  return absl::OkStatus();
}

/// A chunk whose columns were copied counts if they are what the server sent; else the next
/// attempt overwrites it.
absl::Status MeshReceiver::advance(const ChunkNumbers& chunk, std::uint32_t checksum) {
  if (absl::Status status = verify_checksum(chunk, checksum); !status.ok()) return status;
  const ChunkColumns columns = received_.mesh.columns_of(extent_of(chunk));
  if (!ids_are_within(columns.tets, received_.mesh.header)) {
    return bad_stream(
        absl::StrCat("chunk ", chunk.index, " refers to vertices that do not exist"));
  }
  count(chunk);
  return absl::OkStatus();
}

void MeshReceiver::count(const ChunkNumbers& chunk) {
  next_vertex_ = chunk.first_vertex + chunk.vertex_count;
  next_tet_ = chunk.first_tet + chunk.tet_count;
  tets_sent_ += chunk.tet_count;
  ++next_chunk_;
}

absl::Status MeshReceiver::take_trailer(const v1::MeshTrailer& trailer) {
  const MeshHeader& header = received_.mesh.header;
  if (!has_header_ || next_chunk_ != chunks_ ||
      !is_kept(kept_.vertices, next_vertex_, header.vertex_count) ||
      !is_kept(kept_.tets, next_tet_, header.tet_count)) {
    return bad_stream("it ended before the mesh was whole");
  }
  if (auto status = take_statistics(trailer); !status.ok()) return status;
  complete_ = true;
  return absl::OkStatus();
}

absl::Status MeshReceiver::take_statistics(const v1::MeshTrailer& trailer) {
  if (trailer.has_boundary()) {
    const auto boundary = from_proto(trailer.boundary());
    if (!boundary.ok()) return bad_part("boundary", boundary.status());
    received_.boundary = *boundary;
  }
  if (trailer.has_improvement()) {
    const auto improvement = from_proto(trailer.improvement());
    if (!improvement.ok()) return bad_part("improvement", improvement.status());
    received_.improvement = *improvement;
  }
  absl::StatusOr<ThinWalls> walls = from_proto(trailer.thin_walls());
  if (!walls.ok()) return bad_part("thin walls", walls.status());
  received_.thin_walls = *std::move(walls);
  return take_quality(trailer);
}

/// Statistics of some chunks only are no use: the mesh is measured here then.
absl::Status MeshReceiver::take_quality(const v1::MeshTrailer& trailer) {
  has_quality_ = trailer.has_quality() && trailer.first_chunk() == 0 &&
                 unsigned_count(trailer.end_chunk()) == chunks_;
  if (!has_quality_) return absl::OkStatus();
  const auto quality = from_proto(trailer.quality());
  if (!quality.ok()) return bad_part("quality", quality.status());
  received_.quality = *quality;
  return absl::OkStatus();
}

/// Whether the request wants them.
Statistics MeshReceiver::statistics() const {
  return received_.canonical_request.skip_statistics() ? Statistics::kSkipped
                                                       : Statistics::kMeasured;
}

absl::StatusOr<StreamedMesh> MeshReceiver::finish(const Cancellation& cancellation) && {
  if (compact_) {
    absl::StatusOr<FilledMesh> filled = std::move(*compact_).finish(
        received_.mesh.header, cancellation, std::move(used_), statistics());
    if (!filled.ok()) return filled.status();
    received_.mesh = std::move(filled->mesh);
    received_.quality = filled->quality;
    return std::move(received_);
  }
  if (!has_quality_ && statistics() == Statistics::kMeasured) {
    received_.quality = measure_quality(received_.mesh);
  }
  return std::move(received_);
}

}  // namespace tet
