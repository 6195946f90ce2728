// VTK's HDF5 unstructured grid (.vtkhdf), version 1.0.
#pragma once

#include "client/block_writer.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// Writes the whole mesh as one part, regions as `CellData/region`; `file` is left for the
/// caller to commit.
///
/// HDF5 lays the file out and makes its few small parts, in memory; the large columns go
/// straight to their places, so that a full disk or a Ctrl-C ends in our own error and not
/// inside HDF5.
absl::Status write_vtkhdf(AtomicFile& file, const TetMesh& mesh, const WriteControl& control);

}  // namespace tet
