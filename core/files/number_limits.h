// Formats that cannot count as far as a mesh.
#pragma once

#include <cstdint>
#include <limits>
#include <string_view>

#include <absl/status/status.h>

#include "core/files/file_mesh.h"

namespace tet {

inline constexpr std::uint64_t kMostInt32 = std::numeric_limits<std::int32_t>::max();

/// Errors: kFailedPrecondition where a format that numbers nodes, and tets, up to `most` has no
/// numbers for those of the mesh; says what to write instead.
absl::Status check_numbers(const FileMesh& mesh, std::uint64_t most, std::string_view what);

/// Errors: kFailedPrecondition where a format takes fewer than the `count` things of the mesh;
/// `things` says of what, and `what` which format.
absl::Status check_count(std::uint64_t count,
                         std::uint64_t most,
                         std::string_view things,
                         std::string_view what);

}  // namespace tet
