// How large the leaves of a mesh may be, within the limits on how many there may be.
#pragma once

#include <absl/status/statusor.h>

#include "core/base/cancel.h"
#include "core/octree/leaf_rules.h"
#include "core/plan/mesh_request.h"
#include "core/plan/prepared_mesh.h"

namespace tet {

/// What the octree of a mesh covers.
OctreeCover cover_of(const PreparedMesh& prepared);

/// Errors: kResourceExhausted (a sizing that asks for more small leaves than a mesh within the
/// limits has).
absl::StatusOr<LeafRules> leaf_rules_within(const MeshLimits& limits,
                                            const Sizing& sizing,
                                            const PreparedMesh& prepared,
                                            const Cancellation& cancellation);

}  // namespace tet
