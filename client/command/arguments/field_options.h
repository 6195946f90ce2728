// Fields as options: which grids, and where they are.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "core/plan/vertex_field.h"

namespace tet {

/// What the commands say of `--field`, and how it is written.
inline constexpr const char* kFieldHelp =
    "Grid whose values the vertices get as an array, trilinear: of the input, or of another "
    ".vdb; may be repeated: docs/fields.md";
inline constexpr const char* kFieldType = "[ARRAY=][FILE.vdb:]GRID";

/// Fields whose grids are not loaded: `file` is a path, `grids/{sha256}` or a digest, or empty
/// for the input itself. An array is named like its grid unless it says otherwise. Errors:
/// kInvalidArgument (as --field: why).
absl::StatusOr<std::vector<VertexField>> understand_fields(
    const std::vector<std::string>& options);

/// Whether the file of each can have grids; `input` is that of those which name none. Errors:
/// kInvalidArgument.
absl::Status check_field_files(std::span<const VertexField> fields, const std::string& input);

}  // namespace tet
