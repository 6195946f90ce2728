// Sandia's Exodus II (.exo), in a classic netCDF file.
#pragma once

#include "core/files/block_writer.h"
#include "core/files/file_mesh.h"
#include "core/files/file_names.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// What every reader takes: the library itself has longer names only for those that ask for
/// them.
inline constexpr NameRule kExodusNames{.most_bytes = 32};
/// Fields leave two bytes for what tells the components of a vector.
inline constexpr NameRule kExodusFieldNames{.most_bytes = kExodusNames.most_bytes - 2};

/// Writes an element block for each region or part that has tets, a side set and a node set for
/// each label of faces, and fields as nodal variables of one time step; a vector becomes three,
/// with _x, _y and _z at their ends. Elements are numbered block by block; where that changes
/// their order, the element number map has the mesh's numbers plus one. `file` is left for the
/// caller to commit.
///
/// Errors: kFailedPrecondition (more vertices or tets than int32 counts).
absl::Status write_exodus(AtomicFile& file, const FileMesh& mesh, const WriteControl& control);

}  // namespace tet
