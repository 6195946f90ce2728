#include "proto/convert/chunk_numbers.h"

#include "proto/convert/counts.h"

namespace tet {

ChunkNumbers from_proto(const v1::MeshChunk& message) {
  return {unsigned_count(message.index()),        unsigned_count(message.first_vertex()),
          unsigned_count(message.vertex_count()), unsigned_count(message.first_tet()),
          unsigned_count(message.tet_count()),    message.checksum(),
          unsigned_count(message.first_face()),   unsigned_count(message.face_count())};
}

void to_proto(const ChunkNumbers& numbers, v1::MeshChunk& message) {
  message.set_index(signed_count(numbers.index));
  message.set_first_vertex(signed_count(numbers.first_vertex));
  message.set_vertex_count(signed_count(numbers.vertex_count));
  message.set_first_tet(signed_count(numbers.first_tet));
  message.set_tet_count(signed_count(numbers.tet_count));
  message.set_checksum(numbers.checksum);
  message.set_first_face(signed_count(numbers.first_face));
  message.set_face_count(signed_count(numbers.face_count));
}

ChunkExtent extent_of(const ChunkNumbers& numbers) noexcept {
  return {numbers.first_vertex, numbers.vertex_count, numbers.first_tet,
          numbers.tet_count,    numbers.first_face,   numbers.face_count};
}

std::array<std::string_view, kMeshColumns> columns_of(const v1::MeshChunk& message) {
  return {message.positions(), message.tets(),      message.regions(),    message.fields(),
          message.faces(),     message.face_tets(), message.face_labels()};
}

}  // namespace tet
