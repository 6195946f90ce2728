// Where what commands write may go: not where something is that they read.
#pragma once

#include <string>
#include <vector>

#include <absl/status/status.h>

#include "client/command/arguments/mesh_arguments.h"

namespace tet {

/// Refuses an output that would take the place of a file that is read, also through a link.
/// Empty paths are none. Errors: kInvalidArgument.
absl::Status check_takes_no_place(const std::string& output,
                                  const std::vector<std::string>& files_read);

/// OK unless the mesh would take the place of a file that it is made of; or the report cannot
/// be created, or would take the place of such a file or of one of the mesh. Errors: those of
/// check_can_create, kInvalidArgument.
absl::Status check_output_places(const MeshArguments& arguments, const MeshOptions& options);

}  // namespace tet
