// What `tetstream mesh` and `tetstream estimate` both say: an input, a request, and where.
#pragma once

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "client/command/arguments/mesh_options.h"
#include "client/command/arguments/request_options.h"
#include "client/command/arguments/server_options.h"

namespace tet {

/// What the command line says, before it is understood.
struct MeshArguments {
  MeshOptions options;
  RequestArguments request;
  ServerArguments server;
};

/// Adds INPUT, --voxel, --threads, --trust, --sizing-grid, and the options of request and
/// server.
void describe_input(CLI::App& app, MeshArguments& arguments);

/// Errors: those of understand_request and understand_server.
absl::StatusOr<MeshOptions> understand_input(const MeshArguments& arguments);

/// OK unless the input is to be trusted and is read elsewhere. Errors: kInvalidArgument.
absl::Status check_trust(const MeshOptions& options);

/// Whether the options go with the input. Errors: kInvalidArgument.
absl::Status check_input(const MeshOptions& options);

}  // namespace tet
