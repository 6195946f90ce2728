// Points from a text file.
#pragma once

#include <string_view>
#include <vector>

#include <absl/status/statusor.h>

#include "core/base/types.h"

namespace tet {

/// Reads a point a line: three numbers with spaces or commas between them. What follows a # is
/// a comment; empty lines are passed over. Errors: kInvalidArgument, with the line.
absl::StatusOr<std::vector<WorldPoint>> read_points(std::string_view text);

}  // namespace tet
