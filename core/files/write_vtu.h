// VTK's XML unstructured grid (.vtu), with appended raw binary columns.
#pragma once

#include "core/files/block_writer.h"
#include "core/files/file_mesh.h"
#include "core/files/mesh_columns.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// Writes all of the file of a mesh of this header and shape but the columns: see
/// write_columns. What goes wrong is the writer's status.
FileColumns begin_vtu(BlockWriter& writer, const MeshHeader& mesh, const FileShape& shape);

/// Writes the whole mesh, regions as the cells' scalars `region`, labels as `label`, the parts
/// of several grids as `part`, and beside the mesh the number of each grid's part, and of each
/// label that has a name, under that name; `file` is left for the caller to commit.
absl::Status write_vtu(AtomicFile& file, const FileMesh& mesh, const WriteControl& control);

}  // namespace tet
