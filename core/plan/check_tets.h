// Refusals of meshes that were counted: without a tet, or with too many.
#pragma once

#include <absl/status/status.h>

#include "core/mesh/tet_mesh.h"
#include "core/plan/mesh_request.h"
#include "core/plan/prepared_mesh.h"
#include "core/plan/thin_walls.h"

namespace tet {

/// OK or kFailedPrecondition: nothing of a grid that a scene stands for is inside. The message
/// has the range of its values.
absl::Status check_anything_inside(const PhiField& field, double iso);

/// OK or kFailedPrecondition: a grid has no surface, in a box or out of it, so both sides of it
/// cannot be meshed. The message has the range of its values. OK of any scene.
absl::Status check_any_surface(const PhiField& field, double iso);

/// OK or kFailedPrecondition: there is nothing to mesh. The message says why, as far as the
/// walls that were found too thin tell it.
absl::Status check_not_empty(const MeshHeader& header,
                             const PreparedMesh& prepared,
                             const ThinWalls& thin);

/// What check_not_empty answers, or kResourceExhausted: more tets than the limits allow.
absl::Status check_tets(const MeshHeader& header,
                        const PreparedMesh& prepared,
                        const ThinWalls& thin,
                        const MeshLimits& limits);

}  // namespace tet
