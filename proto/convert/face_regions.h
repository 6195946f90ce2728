// Regions of the surface that a request names: messages and JSON, and back.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "core/mesh/face_regions.h"
#include "tetstream/v1/faces.pb.h"
#include "tetstream/v1/meshes.pb.h"

namespace tet {

/// The regions of a request. Errors: kInvalidArgument (a list of other than three numbers, and
/// those of check_face_regions; begins with the field).
absl::StatusOr<std::vector<FaceRegion>> face_regions_of(
    const google::protobuf::RepeatedPtrField<::tetstream::v1::FaceRegion>& messages);

/// Adds the messages that ask for them.
void to_proto(std::span<const FaceRegion> regions, ::tetstream::v1::MeshRequest& message);

/// Reads protobuf's JSON mapping of `FaceRegions`; field names may be as in the .proto file, or
/// in camelCase. Errors: kInvalidArgument (no such JSON, and those of face_regions_of).
absl::StatusOr<std::vector<FaceRegion>> face_regions_from_json(const std::string& json);

/// Writes every byte of a canonical request's regions; the text is empty where there are none.
std::string exact_face_regions(const ::tetstream::v1::MeshRequest& canonical);

}  // namespace tet
