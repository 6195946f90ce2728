// Scenes as messages and as JSON, for both ends of the service.
#pragma once

#include <string>

#include <absl/status/statusor.h>

#include "core/scene/scene.h"
#include "core/scene/scene_nodes.h"
#include "tetstream/v1/scene.pb.h"

namespace tet {

/// Whose grids are not loaded: their files are the names that the message gives. Errors:
/// kInvalidArgument (a list of other than 3 numbers; begins with the field), and that of
/// check_scene.
absl::StatusOr<scene::Description> description_of_message(
    const ::tetstream::v1::Scene& message);

/// Reads protobuf's JSON mapping; field names may be as in the .proto file, or in camelCase.
/// Errors: kInvalidArgument (no such JSON; says where).
absl::StatusOr<::tetstream::v1::Scene> scene_from_json(const std::string& json);

}  // namespace tet
