// Meshes to files.
#pragma once

#include <string>

#include "tetstream/export.h"
#include "tetstream/mesh.h"
#include "tetstream/request.h"
#include "tetstream/status.h"

namespace tetstream {

/// Writes world coordinates; the path's ending chooses the format: .vtu and .vtkhdf (VTK,
/// ParaView), .msh (Gmsh 4.1). The file is whole or not there, and what was at `path` stays
/// until then. Errors: kInvalidArgument (another ending), kUnavailable and kResourceExhausted
/// (the disk), kCancelled, kDeadlineExceeded.
TETSTREAM_API Status write_mesh_file(const std::string& path,
                                     const Mesh& mesh,
                                     const WorkOptions& options = {});

}  // namespace tetstream
