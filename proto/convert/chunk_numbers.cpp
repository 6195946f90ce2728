#include "proto/convert/chunk_numbers.h"

#include "proto/convert/counts.h"

namespace tet {

ChunkNumbers from_proto(const v1::MeshChunk& message) {
  return {unsigned_count(message.index()),        unsigned_count(message.first_vertex()),
          unsigned_count(message.vertex_count()), unsigned_count(message.first_tet()),
          unsigned_count(message.tet_count()),    message.checksum()};
}

void to_proto(const ChunkNumbers& numbers, v1::MeshChunk& message) {
  message.set_index(signed_count(numbers.index));
  message.set_first_vertex(signed_count(numbers.first_vertex));
  message.set_vertex_count(signed_count(numbers.vertex_count));
  message.set_first_tet(signed_count(numbers.first_tet));
  message.set_tet_count(signed_count(numbers.tet_count));
  message.set_checksum(numbers.checksum);
}

}  // namespace tet
