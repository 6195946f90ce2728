// Surfaces as OpenVDB's grids, for who reads grids of files.
#pragma once

#include <cstdint>

#include <absl/status/statusor.h>

#include "core/surface/triangle_surface.h"
#include "core/vdb/openvdb/vdb_grids.h"
#include "core/vdb/plain/conversion_report.h"
#include "core/vdb/walk/charge_file.h"

namespace tet {

/// The grid that surface_to_vdb writes, of solids that overlap with so many pieces at most
/// (core/surface/outer_surface.h). Errors: those of surface_to_volume.
absl::StatusOr<openvdb::FloatGrid::Ptr> surface_to_grid(const TriangleSurface& surface,
                                                        double voxel_size,
                                                        OpenSurface open,
                                                        std::uint64_t most_pieces);

/// Reads a file of triangles, by what its bytes are, and makes a grid of it as fine as
/// default_voxel says with kMostFileBandVoxels. Open surfaces are refused. Errors: those of the
/// reader and of surface_to_volume, told of the file.
absl::StatusOr<openvdb::FloatGrid::Ptr> read_surface_grid(const OpenGridFile& file);

}  // namespace tet
