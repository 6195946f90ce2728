// The options that say what to mesh, as every command takes them.
#pragma once

#include <array>
#include <optional>
#include <string>

#include <absl/status/statusor.h>

#include "client/mesh_client.h"
#include "core/pipeline/mesh_request.h"

namespace CLI {
class App;
}

namespace tet {

/// A command line's request, before it is understood.
struct RequestArguments {
  std::string grid;  ///< empty takes the only meshable grid
  MeshRequest request;
  std::string preset = "default";
  std::optional<std::array<double, 6>> box;
  std::string coordinates;
};

/// Adds --grid, --iso, --spacing, --levels, --preset, --box, --manifold, --improve,
/// --coordinates.
void describe_request(CLI::App& app, RequestArguments& arguments);

/// Errors: kInvalidArgument (options that do not go together).
absl::StatusOr<MeshRequest> understand_request(const RequestArguments& arguments);

/// The same for a server, which stores the file under `name`.
v1::MeshRequest wire_request(const MeshRequest& request,
                             const std::string& name,
                             const std::string& grid);

}  // namespace tet
