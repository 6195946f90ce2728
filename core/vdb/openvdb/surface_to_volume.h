// Triangle surfaces in, level sets out: in memory or as a .vdb file.
#pragma once

#include <string>

#include <absl/status/statusor.h>

#include "core/surface/triangle_surface.h"
#include "core/vdb/openvdb/surface_volume.h"
#include "core/vdb/plain/conversion_report.h"

namespace tet {

/// The narrow-band level set (half width 3 voxels) of a surface, named "surface".
///
/// Inside is what the surface goes around, by its winding number: solids that overlap are one,
/// and a shell that is wound inwards within another is a cavity. Surfaces that are closed but
/// for small faults are mended (core/surface/close_surface.h); of one that is open `open` says
/// what becomes. Error of the values: below a hundredth of a voxel near the surface. The grid
/// is the same for the same surface at any place and of any size, but for surfaces near to the
/// origin, whose voxels are multiples of their size. Errors: kInvalidArgument (voxel size not
/// positive, one whose distances no float holds, or so large that nothing is inside),
/// kFailedPrecondition (the surface is open), kResourceExhausted (so small that the band would
/// not fit, or the pieces of what overlaps; says the value and the limit).
absl::StatusOr<SurfaceVolume> surface_to_volume(const TriangleSurface& surface,
                                                double voxel_size,
                                                OpenSurface open = OpenSurface::kRefuse);

/// Converts a surface and writes the volume to `path` as a .vdb file, which is whole and on
/// disk, or not there at all. The grid's metadata say what it was made of. Errors: also
/// kUnavailable (the file cannot be written).
absl::StatusOr<ConversionReport> surface_to_vdb(const TriangleSurface& surface,
                                                double voxel_size,
                                                const std::string& path,
                                                OpenSurface open = OpenSurface::kRefuse);

}  // namespace tet
