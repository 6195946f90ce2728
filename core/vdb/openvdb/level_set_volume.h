// What a level set goes around.
#pragma once

#include "core/vdb/openvdb/vdb_grids.h"

namespace tet {

/// The volume where a level set is negative, in voxels: of the tets that cubes of eight voxel
/// centres are cut into, with values linear between their corners, as a mesh would have it.
double level_set_volume(const openvdb::FloatGrid& grid);

}  // namespace tet
