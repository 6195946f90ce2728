// Gmsh's mesh format (.msh) 4.1, binary.
#pragma once

#include "client/block_writer.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// Writes the whole mesh as one volume entity; `file` is left for the caller to commit. Tags
/// are ids plus one, since Gmsh counts from one; coordinates are float64, the only kind it
/// knows.
absl::Status write_msh(AtomicFile& file, const TetMesh& mesh, const WriteControl& control);

}  // namespace tet
