// Sizings as messages and as JSON, for both ends of the service.
#pragma once

#include <string>

#include <absl/status/statusor.h>

#include "core/octree/sizing.h"
#include "tetstream/v1/sizing.pb.h"

namespace tet {

/// Errors: kInvalidArgument (a list of other than 3 numbers, and those of check_sizing; begins
/// with the field).
absl::StatusOr<Sizing> sizing_of_message(const ::tetstream::v1::Sizing& message);

/// The message that means this sizing, with every default filled in.
::tetstream::v1::Sizing message_of_sizing(const Sizing& sizing);

/// Reads protobuf's JSON mapping; field names may be as in the .proto file, or in camelCase.
/// Errors: kInvalidArgument (no such JSON; says where).
absl::StatusOr<::tetstream::v1::Sizing> sizing_from_json(const std::string& json);

}  // namespace tet
