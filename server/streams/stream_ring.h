// Shared memory for one stream's chunks, where its client has asked for it.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include <absl/status/statusor.h>

#include "server/shared_memory/chunk_ring.h"
#include "server/streams/mesh_engine.h"

namespace tet {

/// Makes a ring of `blocks` for chunks from `first` on, which is charged to the client before
/// there is any memory, and hands it over. Errors, after which the stream goes without:
/// kResourceExhausted (others need what there is for chunks), those of ChunkRing::open.
absl::StatusOr<std::shared_ptr<ChunkRing>> open_stream_ring(
    MeshEngine& engine,
    const std::string& client,
    std::shared_ptr<SideConnection> connection,
    std::uint64_t blocks,
    std::uint64_t first,
    ChunkRing::Events events);

}  // namespace tet
