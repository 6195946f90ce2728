// Ten-node tets of a mesh with four: the middle nodes of the surface's edges lie on the
// surface.
#pragma once

#include <absl/status/statusor.h>

#include "core/base/cancel.h"
#include "core/mesh/tet_mesh.h"
#include "core/plan/mesh_request.h"
#include "core/plan/shape.h"
#include "core/second_order/middle_nodes.h"

namespace tet {

/// Gives a mesh of `request` and `shape` a node in the middle of each edge. Those of the
/// surface's edges, and of the interface of both sides, lie where phi is zero; all others on
/// the straight line, and those where a tet would be too much deformed on it or half the way.
/// The Jacobian's determinant of every tet is then positive everywhere in it, and nowhere below
/// a fifth of the straight tet's.
///
/// Middle nodes have the values of the request's fields where these are loaded, and otherwise
/// the mean of the edge's ends; the faces of a box that both ends lie in. A grid of sizes need
/// not be loaded.
///
/// Parallel; run it on a TaskPool; the same bytes for any number of threads. Errors: those of
/// canonical and number_edges, kInvalidArgument (the mesh is of other grids), kCancelled,
/// kDeadlineExceeded.
absl::StatusOr<MiddleNodes> make_second_order(const TetMesh& mesh,
                                              const Shape& shape,
                                              const MeshRequest& request,
                                              const Cancellation& cancellation = {});

}  // namespace tet
