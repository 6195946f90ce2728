// Gmsh's mesh format (.msh) 4.1, binary.
#pragma once

#include "core/files/block_writer.h"
#include "core/files/file_mesh.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// Writes the whole mesh as one volume entity, the physical volume "inside" (1). A mesh with
/// regions becomes two, "inside" (1) and "outside" (2); one of several grids becomes a physical
/// volume for each, with the grid's name. The boundary's triangles are written as a surface and
/// a physical surface for each of their labels. `file` is left for the caller to commit.
///
/// Tags are ids plus one, since Gmsh counts from one; coordinates are float64, the only kind it
/// knows. Each volume's tets come together, in the mesh's order; all nodes are in the first.
absl::Status write_msh(AtomicFile& file, const FileMesh& mesh, const WriteControl& control);

}  // namespace tet
