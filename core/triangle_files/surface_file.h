// OBJ, STL and PLY files in, triangles out. Nothing in a file is believed before it is checked.
#pragma once

#include <string>
#include <string_view>

#include <absl/status/statusor.h>

#include "core/surface/triangle_surface.h"

namespace tet {

/// Reads a surface file; its ending (.obj, .stl or .ply, in any case) says how.
///
/// Polygons become triangles, concave ones, too. Colours, normals, texture coordinates and
/// everything else that is no triangle is passed over. Errors: kNotFound and kPermissionDenied
/// (the file), kInvalidArgument (an unknown ending, a file that is malformed, truncated or
/// without triangles: with its line or byte).
absl::StatusOr<TriangleSurface> read_surface(const std::string& path);

/// These read a file's bytes. Errors: kInvalidArgument, with the line or byte.
absl::StatusOr<TriangleSurface> read_obj(std::string_view text);
absl::StatusOr<TriangleSurface> read_stl(
    std::string_view bytes);  ///< vertices of equal bits are one
absl::StatusOr<TriangleSurface> read_ply(std::string_view bytes);

}  // namespace tet
