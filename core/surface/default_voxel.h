// How fine a grid a surface needs.
#pragma once

#include "core/surface/triangle_surface.h"

namespace tet {

/// Voxels near a surface, at most, that thin walls are resolved with: they take a few seconds.
inline constexpr double kMostBandVoxels = 2e7;

/// The longest extent of the triangles / 128, in world units: fine enough to show the shape,
/// coarse enough to mesh in seconds. Less where walls are thinner than two voxels of that, as
/// far as that takes no more than `most_band_voxels`.
double default_voxel(const TriangleSurface& surface, double most_band_voxels = kMostBandVoxels);

}  // namespace tet
