// Points and boxes of a request: messages in, core's types out, and back.
#pragma once

#include <optional>
#include <string>

#include <absl/status/statusor.h>

#include "core/base/types.h"
#include "tetstream/v1/meshes.pb.h"

namespace tet {

namespace v1 = ::tetstream::v1;

// Errors: kInvalidArgument, naming the field, its value and what it may be.

/// Checks the box alone; whether index space holds it depends on the grid.
absl::StatusOr<std::optional<WorldBox>> parse_box(const v1::MeshRequest& request);
absl::StatusOr<std::optional<WorldPoint>> parse_origin(const v1::MeshRequest& request);

/// Writes every bit of a box as hexadecimal floats; the text is empty where there is none.
std::string exact_box(const v1::MeshRequest& request);
std::string exact_origin(const v1::MeshRequest& request);

}  // namespace tet
