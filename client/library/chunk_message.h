// A chunk read from the bytes that came, without a copy of its columns on the way.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

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
  std::array<Column, ChunkFrame::kColumns> columns;  ///< positions, tets, regions, fields
};

/// Copies a column that has the size of its place.
void copy_column(const std::string& from, std::span<std::byte> to);

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
