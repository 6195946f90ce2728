// The fields of a request for a mesh.
#pragma once

#include <span>
#include <string>

#include <absl/status/status.h>

#include "core/plan/mesh_request.h"
#include "tetstream/v1/meshes.pb.h"

namespace tet {

/// Takes the fields as far as they are known before their grids are loaded. Errors:
/// kInvalidArgument, with the field.
absl::Status parse_fields(const ::tetstream::v1::MeshRequest& request, MeshRequest& out);

/// The messages that ask for these, with their files as they are named.
void to_proto(std::span<const VertexField> fields, ::tetstream::v1::MeshRequest& message);

/// Fills in every default of fields that are loaded. The file that is meshed is named already.
void set_canonical_fields(std::span<const VertexField> fields,
                          ::tetstream::v1::MeshRequest& canonical);

/// Writes every byte of a canonical request's fields; the text is empty where there are none.
std::string exact_fields(const ::tetstream::v1::MeshRequest& canonical);

}  // namespace tet
