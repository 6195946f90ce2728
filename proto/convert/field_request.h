// The fields of a request for a mesh.
#pragma once

#include <span>
#include <string>

#include <absl/status/status.h>

#include "core/plan/mesh_request.h"
#include "tetstream/v1/meshes.pb.h"

namespace tet {

/// All that is known of them before their grids are loaded. Errors: kInvalidArgument, with the
/// field.
absl::Status parse_fields(const ::tetstream::v1::MeshRequest& request, MeshRequest& out);

/// Fills in every default of fields that are loaded. The file that is meshed is named already.
void set_canonical_fields(std::span<const VertexField> fields,
                          ::tetstream::v1::MeshRequest& canonical);

/// Every byte of a canonical request's fields; nothing for none.
std::string exact_fields(const ::tetstream::v1::MeshRequest& canonical);

}  // namespace tet
