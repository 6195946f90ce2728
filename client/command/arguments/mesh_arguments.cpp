#include "client/command/arguments/mesh_arguments.h"

#include <string>
#include <utility>

#include <CLI/CLI.hpp>
#include <absl/strings/str_cat.h>

#include "client/command/arguments/field_options.h"
#include "client/command/arguments/mesh_input.h"
#include "client/command/arguments/option_rules.h"
#include "client/command/arguments/placed_array.h"
#include "client/command/arguments/scene_input.h"
#include "client/command/arguments/surface_input.h"
#include "client/command/arguments/volume_file.h"
#include "client/library/read_grids.h"

namespace tet {
namespace {

/// A grid of sizes is in a .vdb file.
absl::Status check_sizing_grid(const MeshOptions& options) {
  const auto& grid = options.request.sizing.grid;
  if (!grid) return absl::OkStatus();
  const std::string& file = grid->file.empty() ? options.input : grid->file;
  if (!is_scene_file(file) && !is_surface_file(file)) {
    return check_mesh_input({file, {}, {}});
  }
  return absl::InvalidArgumentError(
      absl::StrCat(file, " has no grids: name the .vdb of the sizing's with --sizing-grid"));
}

/// Checks --all-grids as far as that is possible while the grids are not known.
absl::Status check_all_grids_option(const MeshOptions& options) {
  if (!options.all_grids || !is_surface_file(options.input)) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("--all-grids: ", options.input, " has no grids; a .vdb file has"));
}

MeshInput input_of(const MeshOptions& options) {
  return {options.input, options.grids, options.surface};
}

/// What excludes what is the same here as on a server.
absl::Status check_option_rules(const MeshOptions& options) {
  const bool names_grids_twice = options.all_grids && !options.grids.empty();
  const Features features = features_of(options.request, input_of(options))
                                .add(Feature::kGridName, names_grids_twice)
                                .add(Feature::kSeveralGrids, options.all_grids)
                                .add(Feature::kPacked, options.packed)
                                .add(Feature::kCompact, options.compact);
  FeatureNames names = option_names(options.request);
  if (options.all_grids) names.set(Feature::kSeveralGrids, "--all-grids");
  return check_features(features, names);
}

absl::Status check_labels(const MeshOptions& options) {
  if (!options.request.labels || is_volume_file(options.input)) return absl::OkStatus();
  if (is_scene_file(options.input)) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(
      "--labels are those of a segmentation in an image (.nii, .nrrd, .mha, .vti, .npy), of "
      "level sets in a .vdb, or of a scene's parts, and ",
      options.input, " is none"));
}

}  // namespace

absl::Status check_trust(const MeshOptions& options) {
  if (!options.trust || options.server.empty()) return absl::OkStatus();
  return absl::InvalidArgumentError(
      "--trust is about a file that is read here: leave --trust or --server out");
}

void describe_input(CLI::App& app, MeshArguments& arguments) {
  MeshOptions& options = arguments.options;
  app.add_option(
         "INPUT", options.input,
         "A .vdb volume, an image (.nii, .nrrd, .mha, .vti, .npy), a closed .obj, .stl or "
         ".ply surface, or a .json scene")
      ->required();
  describe_request(app, arguments.request);
  app.add_flag("--all-grids", options.all_grids,
               "Every grid of the .vdb that can be meshed, in one file");
  app.add_option("--sizing-grid", arguments.request.sizing.grid,
                 "A .vdb with the sizing's grid of sizes, if that is not in the input")
      ->type_name("FILE");
  describe_surface(app, options.surface);
  describe_place(app, options.place);
  app.add_option("--threads", options.threads, "Threads of this process [every core]")
      ->check(CLI::NonNegativeNumber);
  app.add_flag("--trust", options.trust, kTrustHelp);
  describe_server(app, arguments.server);
}

absl::StatusOr<MeshOptions> understand_input(const MeshArguments& arguments) {
  MeshOptions options = arguments.options;
  absl::StatusOr<MeshRequest> request = understand_request(arguments.request);
  if (!request.ok()) return request.status();
  options.request = *std::move(request);
  options.grids = arguments.request.grids;
  options.server = arguments.server.address;
  absl::StatusOr<ChannelOptions> channel = understand_server(arguments.server);
  if (!channel.ok()) return channel.status();
  options.channel = *std::move(channel);
  return options;
}

absl::Status check_input(const MeshOptions& options) {
  absl::Status status = check_option_rules(options);
  if (status.ok()) status = check_labels(options);
  if (status.ok()) status = check_mesh_input(input_of(options));
  if (status.ok()) status = check_all_grids_option(options);
  if (status.ok()) status = check_sizing_grid(options);
  if (status.ok()) status = check_field_files(options.request.fields, options.input);
  if (status.ok()) status = check_trust(options);
  return status;
}

}  // namespace tet
