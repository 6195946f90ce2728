// One grid of a .vdb file: its descriptor, metadata, transform and tree.
#pragma once

#include "core/grid/byte_source.h"
#include "core/grid/vdb_cursor.h"
#include "core/grid/vdb_outline.h"
#include "core/grid/walk_vdb.h"

namespace tet {

/// Walks over the next grid, which may share the tree of one before it in `outline`.
GridOutline walk_grid(VdbCursor& cursor,
                      const ByteSource& source,
                      const VdbOutline& outline,
                      const WalkLimits& limits);

}  // namespace tet
