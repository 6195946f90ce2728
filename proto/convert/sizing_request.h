// The sizing of a request for a mesh.
#pragma once

#include <string>

#include <absl/status/status.h>

#include "core/plan/mesh_request.h"
#include "tetstream/v1/meshes.pb.h"

namespace tet {

/// Takes a sizing, and checks it with the spacing if that is given; a default spacing is known
/// later. Errors: kInvalidArgument, with the field.
absl::Status parse_sizing(const ::tetstream::v1::MeshRequest& request, MeshRequest& out);

/// Fills in every default of a sizing whose grid is loaded. The file is named already.
void set_canonical_sizing(const Sizing& sizing, ::tetstream::v1::MeshRequest& canonical);

/// Writes every byte of a canonical request's sizing; the text is empty where there is none.
std::string exact_sizing(const ::tetstream::v1::MeshRequest& canonical);

}  // namespace tet
