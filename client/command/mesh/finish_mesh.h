// The last steps of every command that ends with a mesh file.
#pragma once

#include <string>

#include <absl/status/status.h>

#include "client/command/mesh/mesh_maker.h"
#include "client/command/process/progress_bar.h"
#include "client/library/mesh_client.h"
#include "core/base/cancel.h"
#include "core/files/mesh_file.h"

namespace tet {

/// A mesh from a server, and the stages that it took.
MadeMesh made_of(StreamedMesh&& streamed, std::vector<Stage> stages);

/// Writes the mesh file and adds the stage, unless it is written, and notes the names that the
/// format changes. Errors: those of write_mesh_file.
absl::Status write_made_mesh(const MeshOutput& output,
                             MadeMesh& made,
                             ProgressBar& bar,
                             const Cancellation& interruption);

}  // namespace tet
