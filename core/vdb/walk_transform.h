// The map from voxels to the world, as files have it.
#pragma once

#include "core/vdb/vdb_cursor.h"

namespace tet {

/// Walks over a transform: any linear map that OpenVDB writes, or a frustum. Its numbers are
/// finite, and those that repeat others (inverses, voxel sizes) agree with them.
void walk_transform(VdbCursor& cursor);

}  // namespace tet
