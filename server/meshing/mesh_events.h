// The messages of a stream of chunks that are not chunks.
#pragma once

#include <cstdint>

#include "core/base/quality_stats.h"
#include "core/plan/mesh_progress.h"
#include "server/meshing/chunk_maker.h"
#include "server/meshing/planner.h"

namespace tet {

v1::MeshEvent progress_event(const MeshProgress& progress);

/// What comes before the chunks of `source`, which is of `planned`.
v1::MeshEvent header_event(const PlannedMesh& planned, const ChunkSource& source);

/// What comes after the last chunk of `source`: chunks [first, end) were sent, with `quality`
/// if they were measured.
v1::MeshEvent trailer_event(const ChunkSource& source,
                            std::uint64_t first,
                            std::uint64_t end,
                            const QualityStats& quality);

}  // namespace tet
