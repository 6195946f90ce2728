// A mesh made from its compact chunks: byte for byte the one that plain chunks carry.
#pragma once

#include <absl/status/statusor.h>

#include "core/base/cancel.h"
#include "core/plan/make/fill_mesh.h"
#include "core/transfer/compact_chunk.h"

namespace tet {

/// Makes the mesh that all chunks of `bricks` together tell, with its statistics unless they
/// are skipped. Parallel; run it on a TaskPool. Made in the memory of `used`, a mesh that is no
/// longer needed, as far as that is enough.
///
/// Errors: kDataLoss (the chunks make another mesh than `header` says, or none),
/// kResourceExhausted (no memory for it), kCancelled, kDeadlineExceeded.
absl::StatusOr<FilledMesh> decode_mesh(CompactBricks bricks,
                                       const MeshHeader& header,
                                       const CompactFrame& frame,
                                       const Cancellation& cancellation,
                                       TetMesh used = {},
                                       Statistics statistics = Statistics::kMeasured);

}  // namespace tet
