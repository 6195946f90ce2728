// The last steps of every command that ends with a mesh file.
#pragma once

#include <string>

#include <absl/status/status.h>

#include "client/command/mesh_maker.h"
#include "client/command/progress_bar.h"
#include "client/library/mesh_client.h"
#include "core/base/cancel.h"

namespace tet {

/// A mesh from a server, and the stages that it took.
MadeMesh made_of(StreamedMesh&& streamed, std::vector<Stage> stages);

/// Writes the mesh file, and adds the stage. Errors: those of write_mesh_file.
absl::Status write_made_mesh(const std::string& output,
                             MadeMesh& made,
                             ProgressBar& bar,
                             const Cancellation& interruption);

}  // namespace tet
