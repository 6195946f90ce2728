// VTK's HDF5 unstructured grid (.vtkhdf), version 1.0.
#pragma once

#include <string>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "core/files/block_writer.h"
#include "core/files/file_mesh.h"
#include "core/files/mesh_columns.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// What the file calls the mesh's parts, which are arrays of a group: HDF5 takes a `/` for the
/// way to something within, and `.` for the group itself.
std::vector<std::string> part_names_in_vtkhdf(const MeshHeader& mesh);

/// Makes the file of a mesh of this header and shape as long as it will be, and writes all of
/// it but the columns: see write_columns. `writer` is one of `file`. Errors: those of
/// AtomicFile, kResourceExhausted (the disk is full), kUnavailable (HDF5 is not there),
/// kCancelled.
absl::StatusOr<FileColumns> begin_vtkhdf(AtomicFile& file,
                                         BlockWriter& writer,
                                         const MeshHeader& mesh,
                                         const FileShape& shape);

/// Writes the whole mesh as one part, regions as `CellData/region` and fields in `PointData`;
/// `file` is left for the caller to commit.
///
/// HDF5 lays the file out and makes its few small parts, in memory; the large columns go
/// straight to their places, so that a full disk or a Ctrl-C ends in our own error and not
/// inside HDF5.
absl::Status write_vtkhdf(AtomicFile& file, const FileMesh& mesh, const WriteControl& control);

}  // namespace tet
