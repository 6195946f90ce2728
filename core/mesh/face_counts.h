// How many faces of a mesh have each label, and which of the request's regions took none.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/mesh/tet_mesh.h"

namespace tet {

/// Faces of each label, in the order of the header's.
std::vector<std::uint64_t> count_faces(const TetMesh& mesh);

/// The name that the request gave a region's label, without that of the grid before it.
std::string name_in_request(const FaceLabel& label, const MeshHeader& header);

/// Names of the regions of the request that no face is in: of several grids', in none of their
/// meshes.
std::vector<std::string> empty_face_regions(const MeshHeader& header,
                                            const std::vector<std::uint64_t>& counts);

}  // namespace tet
