// The labels of a request for a mesh, and those that its header has.
#pragma once

#include <string>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "core/mesh/tet_mesh.h"
#include "core/plan/mesh_request.h"
#include "tetstream/v1/meshes.pb.h"

namespace tet {

/// Takes the choice of labels, if there is one. Errors: kInvalidArgument, with the field.
absl::Status parse_labels(const ::tetstream::v1::MeshRequest& request, MeshRequest& out);

/// The message of a choice, with every default filled in.
::tetstream::v1::Labels message_of_labels(const LabelChoice& choice);

/// Writes every byte of a request's labels; the text is empty where there are none.
std::string exact_labels(const ::tetstream::v1::MeshRequest& canonical);

void to_proto(const MeshLabel& label, ::tetstream::v1::MeshLabel& message);

/// The labels of a header. Errors: kInvalidArgument (too many, a name that cannot be shown, a
/// value that is there twice, beside regions or parts).
absl::StatusOr<std::vector<MeshLabel>> labels_of(const ::tetstream::v1::MeshHeader& message);

}  // namespace tet
