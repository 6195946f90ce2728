// The sizing of a request for a mesh.
#pragma once

#include <string>

#include <absl/status/status.h>

#include "core/plan/mesh_request.h"
#include "tetstream/v1/meshes.pb.h"

namespace tet {

/// A sizing by itself, beside a spacing, and beside what `out` has already; beside a default
/// spacing it is looked at when that is known. Errors: kInvalidArgument, with the field.
absl::Status parse_sizing(const ::tetstream::v1::MeshRequest& request, MeshRequest& out);

/// Fills in every default of a sizing whose grid is loaded. The file is named already.
void set_canonical_sizing(const Sizing& sizing, ::tetstream::v1::MeshRequest& canonical);

/// Every byte of a canonical request's sizing; nothing for none.
std::string exact_sizing(const ::tetstream::v1::MeshRequest& canonical);

}  // namespace tet
