// A chunk read from the bytes that came, without a copy of its columns on the way.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include <grpcpp/support/byte_buffer.h>

#include "core/mesh/tet_mesh.h"
#include "proto/wire/chunk_frame.h"

namespace tet {

/// What a message says of its chunk, and where in it the columns lie.
struct ReceivedChunk {
  struct Column {
    std::size_t begin = 0, size = 0;
  };
  ChunkNumbers numbers;
  std::array<Column, kMeshColumns> columns;  ///< in the order in which they are sent
};

std::array<std::size_t, kMeshColumns> sizes_of(const ReceivedChunk& chunk);
std::array<std::size_t, kMeshColumns> sizes_of(
    const std::array<std::string_view, kMeshColumns>& columns);

/// Copies columns that have the sizes of their places.
void copy_columns(const std::array<std::string_view, kMeshColumns>& from,
                  const ChunkColumns& to);

/// Reads a MeshEvent that holds a chunk as our server writes it: no field twice or unknown, and
/// the columns last. Anything else, malformed bytes too, is left to protobuf: nothing.
/// `message` is read, not changed.
std::optional<ReceivedChunk> read_chunk(grpc::ByteBuffer& message);

/// Copies the columns, each into as many bytes as it has; returns the checksum of what was
/// copied.
std::uint32_t copy_columns(grpc::ByteBuffer& message,
                           const ReceivedChunk& chunk,
                           const ChunkColumns& to);

/// The checksum of the columns where they are.
std::uint32_t columns_checksum(grpc::ByteBuffer& message, const ReceivedChunk& chunk);

}  // namespace tet
