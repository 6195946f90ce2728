// Distances to a surface become those of a solid: which voxels lie within it.
#pragma once

#include <cstdint>
#include <limits>

#include "core/surface/close_surface.h"
#include "core/surface/winding_tree.h"
#include "core/vdb/openvdb/vdb_grids.h"

namespace tet {

/// Walls and gaps that pass between two neighbouring voxel centres, so that no voxel shows
/// them.
struct HiddenSheets {
  std::uint64_t walls = 0, gaps = 0;                          ///< pairs of voxels
  double thinnest = std::numeric_limits<double>::infinity();  ///< voxels

  bool any() const noexcept { return walls + gaps > 0; }
};

struct SignFindings {
  bool overlaps = false;  ///< some voxel lies within two solids, or in one twice
  HiddenSheets hidden;
};

/// Makes a level set of the unsigned distances to a surface, all in voxels; `tree` is of the
/// closed surface that it is all of, or what bounds its inside.
///
/// Between two neighbours whose distances add up to more than their own there is no surface, so
/// they have one sign. What hangs together so asks the winding number of its farthest voxel:
/// inside is what is above kInsideWinding. `nearest` has the surface's triangle that a voxel is
/// nearest to. Voxels beyond the band get the sign of the band next to them.
SignFindings sign_distances(const TriangleSurface& measured,
                            const WindingTree& tree,
                            const openvdb::Int32Grid& nearest,
                            openvdb::FloatGrid& distances);

/// How many bodies of a closed surface no voxel shows: there is none that is nearest to one of
/// its triangles on one side of them or the other. Of a level set as `sign_distances` makes it.
std::uint64_t count_lost_bodies(const ClosedSurface& closed,
                                const openvdb::Int32Grid& nearest,
                                const openvdb::FloatGrid& level_set);

}  // namespace tet
