// Surfaces as input: read, given a voxel size, converted, and told about.
#pragma once

#include <optional>
#include <string>

#include <absl/status/statusor.h>

#include "core/surface/triangle_surface.h"
#include "core/vdb/openvdb/surface_volume.h"
#include "core/vdb/plain/conversion_report.h"

namespace CLI {
class App;
}

namespace tet {

/// Whether a path ends like a surface file: .obj, .stl or .ply.
bool is_surface_file(const std::string& path);

/// What the command line says of a surface that is converted first.
struct SurfaceChoices {
  std::optional<double> voxel;      ///< world units; default_voxel unless given
  std::optional<OpenSurface> open;  ///< refused unless given

  friend auto operator<=>(const SurfaceChoices&, const SurfaceChoices&) = default;
};

/// Adds --voxel and --open.
void describe_surface(CLI::App& app, SurfaceChoices& choices);

/// A surface and what to convert it with.
struct SurfaceInput {
  TriangleSurface surface;
  double voxel_size = 0;
  OpenSurface open = OpenSurface::kRefuse;
};
absl::StatusOr<SurfaceInput> read_surface_input(const std::string& path,
                                                const SurfaceChoices& choices);

/// What was found and done, and a line for each warning.
std::string describe_conversion(const ConversionReport& report);

}  // namespace tet
