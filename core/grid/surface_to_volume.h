// Triangle surfaces in, level sets out, written as a .vdb file.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "core/base/types.h"
#include "core/grid/volume.h"

namespace tet {

/// A triangle surface in world units.
struct TriangleSurface {
  std::vector<WorldPoint> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// What a conversion found and did, for the user to read.
struct ConversionReport {
  std::uint64_t vertices = 0, triangles = 0;
  std::uint64_t open_edges = 0;          ///< edges of one triangle only
  std::uint64_t non_manifold_edges = 0;  ///< edges of three or more
  bool closed = false;                   ///< no open edge: inside is what the surface encloses
  std::uint64_t active_voxels = 0;
};

/// The narrow-band level set (half width 3 voxels) of a closed surface, as an OpenVDB file's
/// bytes would hold it. An open surface has no inside: it becomes a shell one voxel thick
/// around it, and the report says so.
struct SurfaceVolume {
  Volume volume;
  ConversionReport report;
};
absl::StatusOr<SurfaceVolume> surface_to_volume(const TriangleSurface& surface,
                                                double voxel_size);

/// The same, written to `path` as a .vdb file (never left half-written).
absl::StatusOr<ConversionReport> surface_to_vdb(const TriangleSurface& surface,
                                                double voxel_size,
                                                const std::string& path);

}  // namespace tet
