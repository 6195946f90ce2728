// Requests as a server takes them.
#pragma once

#include <string>
#include <vector>

#include "core/plan/mesh_request.h"
#include "tetstream/v1/meshes.pb.h"

namespace tet {

namespace v1 = ::tetstream::v1;

/// The message for a server that stores the file under `name`, and those of the request's
/// fields and sizing as they say. One grid is meshed alone, several together.
v1::MeshRequest wire_request(const MeshRequest& request,
                             const std::string& name,
                             const std::vector<std::string>& grids);

}  // namespace tet
