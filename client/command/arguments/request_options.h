// The options that say what to mesh, as every command takes them.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "client/command/arguments/label_options.h"
#include "client/command/arguments/sizing_input.h"
#include "core/plan/mesh_request.h"

namespace CLI {
class App;
}

namespace tet {

/// A command line's request, before it is understood.
struct RequestArguments {
  std::vector<std::string> grids;  ///< empty takes the only meshable grid
  MeshRequest request;
  std::optional<int> levels;
  std::string inside;  ///< "above", "below" or nothing
  std::string preset = "default";
  std::optional<std::array<double, 6>> box;
  std::string coordinates;
  SizingArguments sizing;
  LabelArguments labels;
  std::vector<std::string> fields;
  std::vector<std::string> faces;  ///< regions
};

/// Adds --grid (any number of times), --iso, --inside, --spacing, --levels, --sizing, --preset,
/// --box, --manifold, --faces, --face, --improve, --coordinates, --field, and those of
/// describe_labels.
void describe_request(CLI::App& app, RequestArguments& arguments);

/// Whether the grids that a file has for --all-grids can be meshed. Errors: kFailedPrecondition
/// (there are none), kInvalidArgument (too many).
absl::Status check_all_grids(const std::string& input, const std::vector<std::string>& grids);

/// The grids of its sizing and its fields are not loaded: see read_sizing and
/// understand_fields. Errors: kInvalidArgument (options that do not go together), and those of
/// the two.
absl::StatusOr<MeshRequest> understand_request(const RequestArguments& arguments);

}  // namespace tet
