// A chunk read from the bytes that came, without a copy of its columns on the way.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include <grpcpp/support/byte_buffer.h>

#include "core/mesh/tet_mesh.h"
#include "proto/wire/chunk_frame.h"

namespace tet {

/// What a message says of its chunk, and where in it the columns lie.
struct ChunkMessage {
  struct Column {
    std::size_t begin = 0, size = 0;
  };
  ChunkNumbers numbers;
  std::array<Column, ChunkFrame::kColumns> columns;  ///< positions, tets, regions, fields
};

/// Reads a MeshEvent that holds a chunk as our server writes it: no field twice or unknown, and
/// the columns last. Anything else, malformed bytes too, is left to protobuf: nothing.
/// `message` is read, not changed.
std::optional<ChunkMessage> read_chunk(grpc::ByteBuffer& message);

/// Copies the columns, each into as many bytes as it has; returns the checksum of what was
/// copied.
std::uint32_t copy_columns(grpc::ByteBuffer& message,
                           const ChunkMessage& chunk,
                           const ChunkColumns& to);

/// The checksum of the columns where they are.
std::uint32_t columns_checksum(grpc::ByteBuffer& message, const ChunkMessage& chunk);

}  // namespace tet
