// The two ways to make a mesh: in this process, or on a server. Both make the same bytes.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "client/command/arguments/mesh_options.h"
#include "client/command/process/progress_bar.h"
#include "core/base/cancel.h"
#include "core/fidelity/fidelity.h"
#include "core/mesh/boundary.h"
#include "core/mesh/improve/improve.h"
#include "core/mesh/quality.h"
#include "core/mesh/tet_mesh.h"
#include "core/plan/mesh_request.h"
#include "core/plan/shape.h"
#include "core/plan/thin_walls.h"
#include "core/second_order/middle_nodes.h"
#include "core/vdb/plain/conversion_report.h"

namespace tet {

struct Stage {
  std::string name;
  double seconds = 0;
};

struct MadeMesh {
  TetMesh mesh;
  /// The file has its name already: the mesh was written as it was made, and `mesh` is nothing
  /// but its header.
  bool is_written = false;
  /// Tets inside, of such a mesh of both sides.
  std::uint64_t tets_inside = 0;
  QualityStats quality;  ///< empty where the request skips statistics
  /// The boundary of the inside, if it was counted with the mesh; else it has to be measured.
  std::optional<BoundaryTopology> boundary;
  std::optional<Improvement> improvement;  ///< where the request asked for it
  ThinWalls thin_walls;
  std::optional<ConversionReport> surface = std::nullopt;  ///< of one that was converted first
  std::optional<MiddleNodes> middles = std::nullopt;       ///< of a mesh of second order
  std::optional<Shape> shape = std::nullopt;  ///< of a mesh made here, while it is wanted
  std::vector<VertexField> fields = {};       ///< loaded, beside it
  /// One, or one a grid of several; empty where nobody measured it, or could, and why.
  std::vector<Fidelity> fidelity = {};
  std::string fidelity_missing = {};
  /// What the voxels of each label have, by their numbers, world units; empty where nobody read
  /// them here.
  std::vector<double> voxel_volumes = {};
  bool cuts_inside = false;    ///< the mesh is not of all that is inside
  std::vector<Stage> stages;   ///< in the order they ran
  std::string transport = {};  ///< how chunks came from a server; empty of a mesh made here
};

absl::StatusOr<MadeMesh> make_mesh_here(const MeshOptions& options,
                                        ProgressBar& bar,
                                        const Cancellation& interruption);

absl::StatusOr<MadeMesh> make_mesh_on_server(const MeshOptions& options,
                                             ProgressBar& bar,
                                             const Cancellation& interruption);

}  // namespace tet
