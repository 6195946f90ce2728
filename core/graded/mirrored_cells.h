// What lies beyond the faces of a box that an octree ends at: the mirror image of what lies
// before them.
#pragma once

#include "core/field/find_bricks.h"
#include "core/octree/cell_set.h"

namespace tet {

/// Adds the mirror images of the cells at each face of the box. Cells of `level` end at a face
/// that is a multiple of their length; where a face is not, there are none.
///
/// A leaf and its image have the tets between them that two leaves have. Half of each lies in
/// the box, and ends at the middle of the face: that is where an image's centre is put.
void add_mirrored(const BrickBox& box, int level, CellSet& cells);

}  // namespace tet
