#include "client/library/part_receiver.h"

#include <cstring>
#include <span>
#include <utility>

#include <absl/strings/str_cat.h>

#include "client/library/chunk_message.h"
#include "client/library/stream_checks.h"
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
    const auto& [positions, tets, regions, fields] = chunk->columns;
    absl::Status status =
        size_part(chunk->numbers, {positions.size, tets.size, regions.size, fields.size});
    if (!status.ok()) return status;
    return hand_on(chunk->numbers, copy_columns(event, *chunk,
                                                {part_.positions.bytes(), part_.tets.bytes(),
                                                 part_.regions.bytes(), part_.fields.bytes()}));
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
  absl::Status status = size_part(numbers, {chunk.positions().size(), chunk.tets().size(),
                                            chunk.regions().size(), chunk.fields().size()});
  if (!status.ok()) return status;
  copy_column(chunk.positions(), part_.positions.bytes());
  copy_column(chunk.tets(), part_.tets.bytes());
  copy_column(chunk.regions(), part_.regions.bytes());
  copy_column(chunk.fields(), part_.fields.bytes());
  return hand_on(numbers, chunk_checksum({chunk.positions(), chunk.tets(), chunk.regions(),
                                          chunk.fields()}));
}

absl::Status PartReceiver::check_place(const ChunkNumbers& chunk) const {
  const ChunkExtent& so_far = covered_;
  const bool follows =
      chunk.index == next_ && next_ < end_ &&
      (!any_ || (chunk.first_vertex == so_far.first_vertex + so_far.vertex_count &&
                 chunk.first_tet == so_far.first_tet + so_far.tet_count));
  const bool fits = is_count(chunk.vertex_count) && is_count(chunk.tet_count) &&
                    chunk.first_vertex <= header_.vertex_count &&
                    chunk.vertex_count <= header_.vertex_count - chunk.first_vertex &&
                    chunk.first_tet <= header_.tet_count &&
                    chunk.tet_count <= header_.tet_count - chunk.first_tet;
  if (follows && fits) return absl::OkStatus();
  return bad_stream(absl::StrCat("chunk ", chunk.index, " is out of place"));
}

absl::Status PartReceiver::size_part(const ChunkNumbers& chunk, const ColumnBytes& columns) {
  if (absl::Status status = check_place(chunk); !status.ok()) return status;
  const ChunkSizes sizes(header_, chunk.vertex_count, chunk.tet_count);
  if (columns != ColumnBytes{sizes.positions, sizes.tets, sizes.regions, sizes.fields}) {
    return bad_stream(absl::StrCat("chunk ", chunk.index, " has columns of a wrong size"));
  }
  MeshHeader of_part = header_;
  of_part.vertex_count = chunk.vertex_count;
  of_part.tet_count = chunk.tet_count;
  part_ = TetMesh(of_part, std::move(part_));
  return absl::OkStatus();
}

absl::Status PartReceiver::hand_on(const ChunkNumbers& chunk, std::uint32_t checksum) {
  if (checksum != chunk.checksum) {
    return bad_stream(absl::StrCat("chunk ", chunk.index, " has a wrong checksum"));
  }
  if (!ids_are_within(part_.tets.bytes(), header_)) {
    return bad_stream(
        absl::StrCat("chunk ", chunk.index, " refers to vertices that do not exist"));
  }
  const ChunkExtent place{chunk.first_vertex, chunk.vertex_count, chunk.first_tet,
                          chunk.tet_count};
  if (absl::Status status = sink_(part_, place); !status.ok()) return status;
  if (!std::exchange(any_, true)) covered_ = {place.first_vertex, 0, place.first_tet, 0};
  covered_.vertex_count += place.vertex_count;
  covered_.tet_count += place.tet_count;
  ++next_;
  return absl::OkStatus();
}

}  // namespace tet
