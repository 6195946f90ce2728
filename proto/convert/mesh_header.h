// The header of a mesh as a message, and back: totals, encodings, fields and parts.
#pragma once

#include <optional>
#include <vector>

#include <absl/status/statusor.h>

#include "core/mesh/tet_mesh.h"
#include "core/plan/mesh_request.h"
#include "tetstream/v1/meshes.pb.h"

namespace tet {

namespace v1 = ::tetstream::v1;

v1::CoordinateType to_proto(CoordinateType type);
v1::IndexType to_proto(IndexType type);
v1::Preset to_proto(Preset preset);

/// They are empty where the number names none, as an unset one does.
std::optional<CoordinateType> from_proto(v1::CoordinateType type);
std::optional<IndexType> from_proto(v1::IndexType type);
std::optional<Preset> from_proto(v1::Preset preset);

using ArrayMessages = google::protobuf::RepeatedPtrField<v1::FieldArray>;

/// Arrays of fields. The messages are not trusted: names may be shown and written into files.
/// Errors: kInvalidArgument, which begins with the field.
void to_proto(const std::vector<FieldArray>& arrays, ArrayMessages& messages);
absl::StatusOr<std::vector<FieldArray>> from_proto(const ArrayMessages& messages);

/// What core knows of a header: neither its mesh's name nor its request.
void to_proto(const MeshHeader& header, v1::MeshHeader& message);

/// The message is not trusted: counts are such that sizes in bytes do not overflow,
/// fields and parts have names that may be shown and written into files, and the parts are all
/// of the mesh, one behind the other. Errors: kInvalidArgument, which begins with the field.
absl::StatusOr<MeshHeader> from_proto(const v1::MeshHeader& message);

}  // namespace tet
