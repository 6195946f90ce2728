// A mesh as fidelity looks at it, wherever its tets are: what both ways of measuring share.
#pragma once

#include <vector>

#include <absl/status/statusor.h>

#include "core/base/cancel.h"
#include "core/fidelity/fidelity.h"
#include "core/mesh/faces.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

struct MeasuredMesh {
  const MeshHeader& header;
  MeshView places;                       ///< of its vertices; without tets
  const std::vector<Triangle>& surface;  ///< as surface_triangles has it
  std::vector<double> volumes;           ///< of the tets inside; of several grids one a grid
};

/// Holds the surface against phi. Errors: those of measure_fidelity.
absl::StatusOr<std::vector<Fidelity>> measure_surface(const MeasuredMesh& mesh,
                                                      const Shape& shape,
                                                      const MeshRequest& request,
                                                      const Cancellation& cancellation);

}  // namespace tet
