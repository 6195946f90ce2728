// VTK's XML unstructured grids (.vtu) as meshes of tets with arrays.
#pragma once

#include <string>

#include <absl/status/statusor.h>

#include "core/remap/data_mesh.h"

namespace tet {

/// Reads a file whose columns are raw and appended, as tetstream writes them: tets alone, with
/// their arrays. Memory follows the file's own size, whatever its counts say.
///
/// Errors: kNotFound and others of files, kInvalidArgument (what it is not, which array and
/// which row), kResourceExhausted (more points or tets than a number of 32 bits counts).
absl::StatusOr<DataMesh> read_vtu(const std::string& path);

}  // namespace tet
