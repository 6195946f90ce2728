// The names of a mesh's faces as messages, and back.
#pragma once

#include <vector>

#include <absl/status/statusor.h>

#include "core/mesh/tet_mesh.h"
#include "tetstream/v1/meshes.pb.h"

namespace tet {

namespace v1 = ::tetstream::v1;

void to_proto(const FaceLabel& label, v1::FaceLabel& message);

/// The labels of a header's faces; its counts are counts. Errors: kInvalidArgument (too many, a
/// name that cannot be shown or is there twice, more faces than the tets have, numbers of tets
/// that ids cannot hold).
absl::StatusOr<std::vector<FaceLabel>> face_labels_of(const v1::MeshHeader& message);

}  // namespace tet
