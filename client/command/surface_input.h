// Closed surfaces as input: read, given a voxel size, and told about.
#pragma once

#include <optional>
#include <string>

#include <absl/status/statusor.h>

#include "core/vdb/surface_to_volume.h"

namespace tet {

/// Whether a path ends like a surface file: .obj, .stl or .ply.
bool is_surface_file(const std::string& path);

/// A surface and the voxel size to convert it with.
struct SurfaceInput {
  TriangleSurface surface;
  double voxel_size = 0;  ///< as asked, or the longest extent / 128
};
absl::StatusOr<SurfaceInput> read_surface_input(const std::string& path,
                                                std::optional<double> voxel_size);

/// What was found and done, in a sentence or two.
std::string describe_conversion(const ConversionReport& report, double voxel_size);

}  // namespace tet
