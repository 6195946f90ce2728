// A survey in blocks, so that many hosts can count one mesh.
#pragma once

#include <cstddef>
#include <vector>

#include <absl/status/statusor.h>

#include "core/base/cancel.h"
#include "core/plan/brick/survey.h"
#include "core/plan/mesh_progress.h"
#include "core/plan/prepared_mesh.h"
#include "core/plan/surveyed_blocks.h"

namespace tet {

/// Blocks of `block_bricks` bricks near the surface that a mesh's survey has. 1 where it is not
/// to be divided: nodes are put back for a manifold one after the other, a mesh with a
/// graded surface is made as a whole, and several grids are planned in turn. Errors: those of
/// prepare_mesh.
absl::StatusOr<std::size_t> count_survey_blocks(const Shape& shape,
                                                const MeshRequest& request,
                                                const MeshLimits& limits,
                                                std::size_t block_bricks,
                                                const Cancellation& cancellation);

/// Surveys one block. Its bytes depend on (shape, request, block_bricks, block) alone.
/// Parallel; run it on a TaskPool. Errors: those of prepare_mesh, kInvalidArgument (there is no
/// such block).
absl::StatusOr<std::vector<std::byte>> survey_block(const Shape& shape,
                                                    const MeshRequest& request,
                                                    const MeshLimits& limits,
                                                    std::size_t block_bricks,
                                                    std::size_t block,
                                                    const Cancellation& cancellation);

/// The whole survey: of blocks that were surveyed before, and of the rest as it is surveyed
/// here. Errors: kCancelled, kDeadlineExceeded. `progress` may be null.
absl::StatusOr<Survey> join_survey(const PreparedMesh& prepared,
                                   const SurveyedBlocks& surveyed,
                                   const Cancellation& cancellation,
                                   MeshProgress* progress);

}  // namespace tet
