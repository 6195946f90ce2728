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

/// Of the box alone; whether index space holds it depends on the grid.
absl::StatusOr<std::optional<WorldBox>> parse_box(const v1::MeshRequest& request);
absl::StatusOr<std::optional<WorldPoint>> parse_origin(const v1::MeshRequest& request);

void set_point(const WorldPoint& point, v1::Point& message);
void set_box(const WorldBox& box, v1::Box& message);

/// Every bit of a box, as hexadecimal floats; nothing for none.
std::string exact_box(const v1::MeshRequest& request);
std::string exact_origin(const v1::MeshRequest& request);

}  // namespace tet
