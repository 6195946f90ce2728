// The map from voxels to the world, as files have it.
#pragma once

#include <optional>

#include "core/vdb/walk/vdb_cursor.h"
#include "core/vdb/walk/vdb_outline.h"

namespace tet {

/// Walks over a transform: any linear map that OpenVDB writes, or a frustum. Its numbers are
/// finite, and those that repeat others (inverses, voxel sizes) agree with them. Returns it if
/// it goes along the axes.
std::optional<AxisMap> walk_transform(VdbCursor& cursor);

}  // namespace tet
