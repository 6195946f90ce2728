// XDMF 3 (.xdmf) with its columns in an HDF5 file (.h5) beside it, laid out as dolfinx reads
// it.
#pragma once

#include <string>

#include "core/files/block_writer.h"
#include "core/files/file_mesh.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// Writes three grids: `mesh` with topology, geometry and fields; `cell_tags`, of each tet its
/// region or part (1 where there is none); `facet_tags`, of each boundary triangle the number
/// of its label from 1 on. Names are told by `Information` elements of the two.
///
/// `index` becomes the .xdmf and `columns` the .h5, which `columns_name` is the name of. Both
/// are left for the caller to commit.
absl::Status write_xdmf(AtomicFile& index,
                        AtomicFile& columns,
                        const std::string& columns_name,
                        const FileMesh& mesh,
                        const WriteControl& control);

}  // namespace tet
