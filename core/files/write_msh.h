// Gmsh's mesh format (.msh) 4.1, binary.
#pragma once

#include "core/files/block_writer.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// Writes the whole mesh as one volume entity. A mesh with regions becomes two, the physical
/// volumes "inside" (1) and "outside" (2); one of several grids becomes a physical volume for
/// each, with the grid's name. Where a box cuts the mesh, the boundary's triangles are written,
/// too, as physical surfaces: see msh_surfaces.h. `file` is left for the caller to commit.
///
/// Tags are ids plus one, since Gmsh counts from one; coordinates are float64, the only kind it
/// knows. Each volume's tets come together, in the mesh's order; all nodes are in the first.
absl::Status write_msh(AtomicFile& file, const TetMesh& mesh, const WriteControl& control);

}  // namespace tet
