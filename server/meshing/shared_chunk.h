// A chunk of a counted mesh, made in memory that its client reads.
#pragma once

#include <cstdint>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "core/base/cancel.h"
#include "server/meshing/chunk_maker.h"
#include "server/shared_memory/chunk_ring.h"

namespace tet {

/// Whether a source makes its chunks without reading anything of them to find its way by: a
/// client that overrules files' rights can write to its own ring. An improved mesh is measured
/// by the ids in its chunks. Errors: kFailedPrecondition.
absl::Status check_not_read_back(const ChunkSource& source);

/// Makes chunk `index` of a plain source in its block of the ring, and the message that tells
/// of it. Nothing is read from the block once this has returned. A chunk that is larger than a
/// block comes as it would without a ring. Errors: those of make_chunk.
absl::StatusOr<ChunkMessage> make_shared_chunk(const ChunkSource& source,
                                               std::uint64_t index,
                                               ChunkMemory memory,
                                               const ChunkRing& ring,
                                               const Cancellation& cancellation);

}  // namespace tet
