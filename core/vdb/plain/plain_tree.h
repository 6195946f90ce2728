// The nodes of a tree of real numbers, read from where the walker found them.
#pragma once

#include <vector>

#include <absl/status/statusor.h>

#include "core/vdb/walk/vdb_cursor.h"
#include "core/vdb/walk/vdb_outline.h"
#include "core/volume/volume.h"
#include "core/volume/volume_builder.h"

namespace tet {

/// Fills in the volume's background, bricks, values and cubes. Returns the bricks of one value.
/// `grid` has been walked over and its values are float or double. Throws WalkRefusal where
/// values do not unpack, or the file is not what it was. Errors: those of check_background.
absl::StatusOr<std::vector<ConstantBrick>> read_plain_tree(const ByteSource& source,
                                                           const GridOutline& grid,
                                                           Volume& volume);

/// What a list of grids says of a root, its nodes apart.
struct PlainRoot {
  float background = 0;
  bool empty = false;  ///< it has no entry but inactive tiles of the background
};

/// Throws WalkRefusal where the file is not what it was.
PlainRoot read_plain_root(const ByteSource& source, const GridOutline& grid);

}  // namespace tet
