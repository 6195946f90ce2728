// What is told of a mesh whose request asks for fidelity, as a message, and back.
#pragma once

#include <optional>

#include <absl/status/statusor.h>

#include "core/fidelity/fidelity.h"
#include "tetstream/v1/meshes.pb.h"

namespace tet {

namespace v1 = ::tetstream::v1;

/// Adds it to what a trailer tells.
void to_proto(const MeshFidelity& fidelity, v1::MeshTrailer& trailer);

/// Returns what a trailer tells, if it does. It is not trusted: counts are such that sums of
/// them do not overflow, and numbers are finite. Errors: kInvalidArgument, which begins with
/// the field.
absl::StatusOr<std::optional<MeshFidelity>> fidelity_of(const v1::MeshTrailer& trailer);

}  // namespace tet
