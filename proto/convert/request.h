// Requests for meshes: messages in, core's types out, and back. What excludes what is in
// request_rules.h; other messages are converted in the files beside this one.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "core/plan/mesh_request.h"
#include "core/plan/shape.h"
#include "core/scene/scene_nodes.h"
#include "tetstream/v1/grids.pb.h"
#include "tetstream/v1/meshes.pb.h"

namespace tet {

namespace v1 = ::tetstream::v1;

/// A request for a mesh that was found valid.
struct MeshOrder {
  /// The grid file's; it is empty where a scene is meshed.
  std::string digest;
  /// One grid of the file; it is empty where several are named, and may be where there is one.
  std::string grid_name;
  MeshRequest request;
  std::vector<std::string> grid_names = {};
  /// The caller's namespace, which whoever knows the call fills in.
  std::string space = {};
  /// It has no nodes where a grid is meshed. The planner loads its grids.
  scene::Description scene = {};
  /// The scene as it was sent.
  v1::Scene scene_message = {};
  /// It is null where the scene has grids, which are not loaded yet.
  std::shared_ptr<const Scene> made_scene = nullptr;
  /// A session's changed grid, which is meshed instead of the stored one.
  std::shared_ptr<const Volume> volume = nullptr;
  /// A frame's plan is kept for nobody but its session.
  bool is_frame = false;

  bool is_scene() const noexcept { return !scene.nodes.empty(); }
};

/// A request for chunks of a mesh that was found valid.
struct StreamOrder {
  MeshOrder mesh;
  std::uint64_t start_chunk = 0;
  std::uint64_t end_chunk = 0;  ///< 0 asks for all that follow
  std::string expected_mesh_id;
  v1::Encoding encoding = v1::ENCODING_PLAIN;
  /// The earlier mesh, and its grid file. Both are empty where nothing can be kept of one.
  std::string base_mesh_id;
  std::string base_digest;
  /// The request's name if the stored result of a job will do as well; else it is empty.
  std::string stored_name = {};
  /// What the client was told beside gRPC, if it asks for shared memory; else it is empty.
  std::string shared_memory = {};
  bool shared_memory_events = false;  ///< and it hears of its chunks there
};

/// Errors: kInvalidArgument, naming the field, its value and what it may be.
absl::StatusOr<std::string> parse_grid_name(const std::string& name);
absl::StatusOr<MeshOrder> parse_mesh_request(const v1::MeshRequest& request);
absl::StatusOr<StreamOrder> parse_stream_request(const v1::StreamMeshRequest& request);

/// The message that asks for this, but for what is meshed. Files of fields and sizes are named
/// as the request names them.
void to_proto(const MeshRequest& request, v1::MeshRequest& message);

/// Lists the digests of all files that an order is about, each once.
std::vector<std::string> files_of(const MeshOrder& order);

/// Fills in every default of a request but the box, which is the shape's extent if it is unset.
/// `coordinates` stays unset only if `header` is null. Where several grids are meshed, spacing
/// and iso stay unset unless they were given, as each grid has its own.
v1::MeshRequest canonical_request(const MeshOrder& order,
                                  const Shape& shape,
                                  const MeshHeader* header);

/// A request's name: SHA-256 of what was asked for and the algorithm's version. Two requests of
/// one name ask for one mesh, whether or not they skip its statistics.
std::string name_of_request(v1::MeshRequest request);

/// A mesh's name, which is the same for the same bytes: SHA-256 over digest or scene, canonical
/// request and algorithm version, as 64 hexadecimal digits.
std::string mesh_id_of(const v1::MeshRequest& canonical);

}  // namespace tet
