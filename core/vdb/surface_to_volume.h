// Triangle surfaces in, level sets out: in memory or as a .vdb file.
#pragma once

#include <cstdint>
#include <string>

#include <absl/status/statusor.h>

#include "core/surface/triangle_surface.h"
#include "core/volume/volume.h"

namespace tet {

/// What a conversion found and did.
struct ConversionReport {
  std::uint64_t vertices = 0, triangles = 0;
  std::uint64_t open_edges = 0;          ///< edges of one triangle only
  std::uint64_t non_manifold_edges = 0;  ///< edges of three or more
  bool closed = false;                   ///< no open edge: inside is what the surface encloses
  std::uint64_t active_voxels = 0;

  /// Tells the user in one sentence which it was, and what was done.
  std::string text() const;
};

struct SurfaceVolume {
  Volume volume;
  ConversionReport report;
};

/// The narrow-band level set (half width 3 voxels) of a surface, named "surface".
///
/// A closed surface's inside is what cannot be reached from far away, so hollows are filled. An
/// open one has no inside: it becomes a shell two voxels thick, one on either side. Vertices of
/// equal coordinates count as one. Error of the values: OpenVDB's, below a hundredth of a voxel
/// near the surface. Errors: kInvalidArgument (voxel size not positive, or so large that
/// nothing is inside), kResourceExhausted (so small that the band would not fit; says the value
/// and the limit).
absl::StatusOr<SurfaceVolume> surface_to_volume(const TriangleSurface& surface,
                                                double voxel_size);

/// Converts a surface and writes the volume to `path` as a .vdb file, which is whole and on
/// disk, or not there at all. Errors: also kUnavailable (the file cannot be written).
absl::StatusOr<ConversionReport> surface_to_vdb(const TriangleSurface& surface,
                                                double voxel_size,
                                                const std::string& path);

}  // namespace tet
