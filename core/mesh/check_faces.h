// Whether the faces of a chunk that somebody sent are faces of its tets.
#pragma once

#include "core/mesh/tet_mesh.h"

namespace tet {

/// Whether each face of a chunk belongs to one of the chunk's tets, in their order and none
/// twice, is one of that tet's four as face_of has it, and has a label that there is. Then its
/// ids are as right as those of the tets.
bool faces_are_of_tets(const MeshHeader& header,
                       const ChunkExtent& chunk,
                       const ConstColumns& columns) noexcept;

}  // namespace tet
