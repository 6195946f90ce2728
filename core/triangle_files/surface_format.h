// What a file of triangles is by its bytes, where no name tells.
#pragma once

#include <cstdint>
#include <string_view>

#include <absl/status/statusor.h>

#include "core/surface/triangle_surface.h"

namespace tet {

enum class SurfaceFormat : std::uint8_t { kNone, kObj, kStl, kPly };

/// As much of a file as tells what it is.
inline constexpr std::size_t kSurfaceMagicBytes = 4096;

/// What a file of `file_bytes` bytes that begins with `head` is: PLY and text STL say so in
/// their first line, binary STL has the size that its count of triangles asks for, and an OBJ
/// file's first line that is no comment has a keyword of one.
SurfaceFormat surface_format(std::string_view head, std::uint64_t file_bytes) noexcept;

/// Reads a file's bytes by what they are. Errors: those of the reader; kInvalidArgument (none).
absl::StatusOr<TriangleSurface> read_surface_bytes(std::string_view bytes);

}  // namespace tet
