// Meshes to files.
#pragma once

#include <string>

#include "tetstream/export.h"
#include "tetstream/mesh.h"
#include "tetstream/request.h"
#include "tetstream/status.h"

namespace tetstream {

/// Writes world coordinates; the path's ending chooses the format, .vtu or .msh or one of the
/// others that docs/formats.md lists. The file is whole or not there, and what was at `path`
/// stays until then. Errors: kInvalidArgument (another ending), kFailedPrecondition (a format
/// that cannot count so far), kUnavailable and kResourceExhausted (the disk), kCancelled,
/// kDeadlineExceeded.
TETSTREAM_API Status write_mesh_file(const std::string& path,
                                     const Mesh& mesh,
                                     const WorkOptions& options = {});

/// Writes the format of this name, whatever the path's ending: "vtu", "msh" and so on, as
/// `tetstream formats` lists them. Errors: also kInvalidArgument (no such format).
TETSTREAM_API Status write_mesh_file(const std::string& path,
                                     const Mesh& mesh,
                                     const std::string& format,
                                     const WorkOptions& options = {});

}  // namespace tetstream
