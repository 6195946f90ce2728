// Sizings as options: JSON files, or the JSON itself, and files of their grids.
#pragma once

#include <optional>
#include <string>

#include <absl/status/statusor.h>

#include "core/octree/sizing.h"

namespace tet {

/// What `--sizing` and `--sizing-grid` say; either may be empty.
struct SizingArguments {
  std::string sizing;  ///< a file, or text that begins with a brace
  std::string grid;    ///< a .vdb file with the sizing's grid
};

/// A sizing whose grid, if there is one, is not loaded: its `file` is a path, or empty for the
/// input itself. Errors: kNotFound, kInvalidArgument (not a sizing; says where), both with the
/// path.
absl::StatusOr<Sizing> read_sizing(const SizingArguments& arguments);

}  // namespace tet
