// MFEM's mesh format, version 1.0 (.mesh).
#pragma once

#include "core/files/block_writer.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// Writes tets with the number of their region or part as attribute, and boundary triangles
/// with the number of their label. Version 1.0, which every MFEM reads, has no names: comments
/// tell them. `file` is left for the caller to commit. Errors: kFailedPrecondition (more
/// vertices or tets than MFEM's int counts).
absl::Status write_mfem(AtomicFile& file, const TetMesh& mesh, const WriteControl& control);

}  // namespace tet
