// One grid of a .vdb file: its descriptor, metadata, transform and tree.
#pragma once

#include "core/vdb/walk/vdb_cursor.h"
#include "core/vdb/walk/vdb_outline.h"
#include "core/vdb/walk/walk_vdb.h"

namespace tet {

/// Walks over the next grid, which may share the tree of one before it in `outline`.
GridOutline walk_grid(VdbCursor& cursor, const VdbOutline& outline, const WalkLimits& limits);

}  // namespace tet
