// What is checked of every stream of a mesh before it is used: nothing that a server says is
// trusted.
#pragma once

#include <string>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "core/mesh/tet_mesh.h"
#include "tetstream/v1/meshes.pb.h"

namespace tet {

namespace v1 = ::tetstream::v1;

/// kDataLoss: "the server's stream is broken: `message`".
absl::Status bad_stream(const std::string& message);

/// A header as core has it. Errors: kDataLoss (impossible values).
absl::StatusOr<MeshHeader> checked_header(const v1::MeshHeader& message);

}  // namespace tet
