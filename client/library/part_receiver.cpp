#include "client/library/part_receiver.h"

#include <cstring>
#include <span>
#include <utility>

#include <absl/strings/str_cat.h>

#include "client/library/check_labels.h"
#include "client/library/chunk_message.h"
#include "client/library/stream_checks.h"
#include "core/mesh/check_faces.h"
#include "proto/convert/chunk_numbers.h"
#include "proto/convert/counts.h"
#include "proto/wire/checksum.h"
#include "proto/wire/serialized.h"

namespace tet {

PartReceiver::PartReceiver(const MeshHeader& header,
                           std::string mesh_id,
                           std::uint64_t first,
                           std::uint64_t end,
                           PartSink sink)
    : header_(header),
      mesh_id_(std::move(mesh_id)),
      end_(end),
      sink_(std::move(sink)),
      next_(first) {}

absl::Status PartReceiver::take(grpc::ByteBuffer& event) {
  if (const auto chunk = read_chunk(event)) {
    absl::Status status = size_part(chunk->numbers, sizes_of(*chunk));
    if (!status.ok()) return status;
    return hand_on(chunk->numbers, copy_columns(event, *chunk, part_.mesh().columns()));
  }
  v1::MeshEvent message;
  if (!deserialize(event, message)) return bad_stream("a message that is no MeshEvent");
  return take(message);
}

absl::Status PartReceiver::take(const v1::MeshEvent& event) {
  if (event.has_chunk()) return take_chunk(event.chunk());
  if (!event.has_header() || event.header().mesh_id() == mesh_id_) return absl::OkStatus();
  return bad_stream("another mesh than was asked for");
}

absl::Status PartReceiver::take_chunk(const v1::MeshChunk& chunk) {
  const ChunkNumbers numbers = from_proto(chunk);
  const auto received = columns_of(chunk);
  absl::Status status = size_part(numbers, sizes_of(received));
  if (!status.ok()) return status;
  copy_columns(received, part_.mesh().columns());
  return hand_on(numbers, chunk_checksum(received));
}

absl::Status PartReceiver::check_place(const ChunkNumbers& chunk) const {
  const ChunkExtent& so_far = covered_;
  const bool follows =
      chunk.index == next_ && next_ < end_ &&
      (!any_ || (chunk.first_vertex == so_far.first_vertex + so_far.vertex_count &&
                 chunk.first_tet == so_far.first_tet + so_far.tet_count &&
                 chunk.first_face == so_far.first_face + so_far.face_count));
  const auto fits_in = [](std::uint64_t first, std::uint64_t count, std::uint64_t all) {
    return is_count(count) && first <= all && count <= all - first;
  };
  const bool fits = fits_in(chunk.first_vertex, chunk.vertex_count, header_.vertex_count) &&
                    fits_in(chunk.first_tet, chunk.tet_count, header_.tet_count) &&
                    fits_in(chunk.first_face, chunk.face_count, header_.face_count);
  if (follows && fits) return absl::OkStatus();
  return bad_stream(absl::StrCat("chunk ", chunk.index, " is out of place"));
}

absl::Status PartReceiver::size_part(const ChunkNumbers& chunk, const ColumnBytes& columns) {
  if (absl::Status status = check_place(chunk); !status.ok()) return status;
  const ChunkExtent extent = extent_of(chunk);
  if (columns != ChunkSizes(header_, extent).all()) {
    return bad_stream(absl::StrCat("chunk ", chunk.index, " has columns of a wrong size"));
  }
  part_.make(header_of_chunk(header_, extent));
  return absl::OkStatus();
}

absl::Status PartReceiver::hand_on(const ChunkNumbers& chunk, std::uint32_t checksum) {
  if (checksum != chunk.checksum) {
    return bad_stream(absl::StrCat("chunk ", chunk.index, " has a wrong checksum"));
  }
  const TetMesh& part = part_.mesh();
  if (!ids_are_within(part.tets.bytes(), header_)) {
    return bad_stream(
        absl::StrCat("chunk ", chunk.index, " refers to vertices that do not exist"));
  }
  if (!labels_are_within(part.regions.bytes(), header_)) {
    return bad_stream(absl::StrCat("chunk ", chunk.index, " has labels that do not exist"));
  }
  const ChunkExtent place = extent_of(chunk);
  if (!faces_are_of_tets(header_, place, part.columns())) {
    return bad_stream(
        absl::StrCat("chunk ", chunk.index, " has faces that are not of its tets"));
  }
  if (absl::Status status = sink_(part, place); !status.ok()) return status;
  if (!std::exchange(any_, true)) {
    covered_ = {place.first_vertex, 0, place.first_tet, 0, place.first_face, 0};
  }
  covered_.vertex_count += place.vertex_count;
  covered_.tet_count += place.tet_count;
  covered_.face_count += place.face_count;
  ++next_;
  return absl::OkStatus();
}

}  // namespace tet
