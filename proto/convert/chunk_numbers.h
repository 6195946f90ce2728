// The numbers of a chunk as a message, and back.
#pragma once

#include "proto/wire/chunk_frame.h"
#include "tetstream/v1/meshes.pb.h"

namespace tet {

namespace v1 = ::tetstream::v1;

/// Negative numbers become huge ones, which whoever places the chunk refuses.
ChunkNumbers from_proto(const v1::MeshChunk& message);

/// Leaves what the chunk holds as it is.
void to_proto(const ChunkNumbers& numbers, v1::MeshChunk& message);

}  // namespace tet
