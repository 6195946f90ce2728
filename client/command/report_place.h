// Where a mesh's report may go.
#pragma once

#include <absl/status/status.h>

#include "client/command/mesh_arguments.h"

namespace tet {

/// OK unless the report cannot be created, or would take the place of a file of the mesh, or of
/// one that the mesh is made of. Errors: those of check_can_create, kInvalidArgument.
absl::Status check_report_place(const MeshArguments& arguments, const MeshOptions& options);

}  // namespace tet
