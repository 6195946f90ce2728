// Messages in, core's types out, and back: the one place where requests are validated.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "core/mesh/boundary.h"
#include "core/mesh/improve.h"
#include "core/mesh/lattice_to_world.h"
#include "core/mesh/quality.h"
#include "core/mesh/splice.h"
#include "core/plan/mesh_request.h"
#include "core/plan/shape.h"
#include "core/plan/thin_walls.h"
#include "core/scene/scene_nodes.h"
#include "core/volume/grid_info.h"
#include "tetstream/v1/grids.pb.h"
#include "tetstream/v1/meshes.pb.h"

namespace tet {

namespace v1 = ::tetstream::v1;

/// A valid request for a mesh.
struct MeshOrder {
  std::string digest;     ///< of the grid file; empty where there is a scene
  std::string grid_name;  ///< within it; may be empty
  MeshRequest request;
  std::vector<std::string> grid_names = {};  ///< of several grids instead
  std::string space = {};  ///< the caller's namespace, from whoever knows the call
  scene::Description scene =
      {};                        ///< whose grids are loaded later; no nodes where there is none
  v1::Scene scene_message = {};  ///< the same, as it was sent
  std::shared_ptr<const Scene> made_scene = nullptr;  ///< unless it has grids
  std::shared_ptr<const Volume> volume = nullptr;  ///< instead of the stored grid, once changed
  bool is_frame = false;  ///< of a session: its plan is kept for nobody else

  bool is_scene() const noexcept { return !scene.nodes.empty(); }
};

/// A valid request for chunks of it.
struct StreamOrder {
  MeshOrder mesh;
  std::uint64_t start_chunk = 0;
  std::uint64_t end_chunk = 0;  ///< 0: all
  std::string expected_mesh_id;
  v1::Encoding encoding = v1::ENCODING_PLAIN;
  std::string base_mesh_id;  ///< empty: no earlier mesh
  std::string base_digest;   ///< of its grid file
  /// The request's name, where the result of a job will do as well; else empty.
  std::string stored_name = {};
};

/// Errors: kInvalidArgument, naming the field, its value and what it may be.
absl::StatusOr<std::string> parse_grid_name(const std::string& name);
absl::StatusOr<MeshOrder> parse_mesh_request(const v1::MeshRequest& request);
absl::StatusOr<StreamOrder> parse_stream_request(const v1::StreamMeshRequest& request);

/// Digests of all files that an order is about, each once.
std::vector<std::string> files_of(const MeshOrder& order);

/// The request with every default filled in, but for a box: without one it is the
/// shape's extent. `coordinates` stays unset only if `header` is null. Of several grids each
/// has its own spacing and iso unless they are given.
v1::MeshRequest canonical_request(const MeshOrder& order,
                                  const Shape& shape,
                                  const MeshHeader* header);

/// A request's name: SHA-256 of what was asked for and the algorithm's version. Two requests of
/// one name ask for one mesh, whether or not they skip its statistics.
std::string name_of_request(v1::MeshRequest request);

/// A mesh's name: the same for the same bytes. SHA-256 over digest or scene, canonical
/// request and algorithm version, as 64 hexadecimal digits.
std::string mesh_id_of(const v1::MeshRequest& canonical);

v1::CoordinateType to_proto(CoordinateType type);
v1::IndexType to_proto(IndexType type);
v1::Preset to_proto(Preset preset);
void to_proto(const GridInfo& info, v1::GridInfo& message);
void to_proto(const MeshPart& part, v1::MeshPart& message);
void to_proto(const MeshHeader& header, v1::MeshHeader& message);
void to_proto(const KeptParts& kept, v1::KeptParts& message);
void to_proto(const LatticeToWorld& to_world, v1::Lattice& message);
void to_proto(const Improvement& improvement, v1::Improvement& message);
void to_proto(const QualityStats& stats, v1::QualityStats& message);
void to_proto(const BoundaryTopology& boundary, v1::BoundaryTopology& message);
void to_proto(const ThinWalls& walls, v1::ThinWalls& message);

}  // namespace tet
