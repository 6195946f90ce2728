#include "client/command/arguments/request_options.h"

#include <map>

#include <CLI/CLI.hpp>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "client/command/arguments/face_options.h"
#include "client/command/arguments/field_options.h"
#include "core/plan/joined/joined_plan.h"
#include "core/volume/inside.h"

namespace tet {
namespace {

/// Whether their names can be those of several grids.
absl::Status check_grids(const std::vector<std::string>& grids) {
  const absl::Status status = check_grid_names(grids);
  if (status.ok()) return status;
  return absl::InvalidArgumentError(absl::StrCat("--grid: ", status.message()));
}

}  // namespace

void describe_request(CLI::App& app, RequestArguments& arguments) {
  MeshRequest& request = arguments.request;
  app.add_option(
         "--grid", arguments.grids,
         "Grid of the .vdb; may be repeated for several in one file [its only meshable one]")
      ->type_name("NAME")
      ->allow_extra_args(false);
  app.add_option("--iso", request.iso, "Value of the surface [0; 0.5 for fog volumes]");
  app.add_option("--inside", arguments.inside,
                 "Which side of the iso value is inside: above or below [what the grid's class "
                 "says, or else its values: docs/inside.md]")
      ->check(CLI::IsMember({"above", "below"}));
  app.add_option("--spacing", request.spacing,
                 "Finest lattice spacing, world units [voxel size; of a scene its longest "
                 "extent / 128]");
  app.add_option("--levels", arguments.levels,
                 "Coarser octree levels inside: 0 is uniform, max as coarse as the inside "
                 "allows [1; max with a sizing that has coarsest, growth or a grid]")
      ->transform(
          CLI::Transformer(std::map<std::string, int>{{"max", kMaxLevels}}).description(""))
      ->type_name("N|max");
  app.add_option("--sizing", arguments.sizing.sizing,
                 "JSON file, or JSON, that says how large tets may be, and where: "
                 "docs/sizing.md")
      ->type_name("FILE");
  app.add_option("--preset", arguments.preset,
                 "default, min-angle (the best smallest angle) or both-sides (meshes the "
                 "outside too)")
      ->check(CLI::IsMember({"default", "min-angle", "both-sides"}));
  app.add_option("--box", arguments.box,
                 "What to mesh, world units, rounded outward to 8 spacings: how far both-sides "
                 "goes [all that the grid stores or the scene reaches]; else the inside is cut "
                 "off there, flat")
      ->type_name("X0 Y0 Z0 X1 Y1 Z1");
  app.add_flag("--manifold", request.manifold, "Keep the boundary from touching itself");
  app.add_flag("--faces", request.faces,
               "Boundary triangles beside the tets, with names: docs/faces.md");
  app.add_option("--face", arguments.faces, kFaceHelp)
      ->type_name(kFaceType)
      ->allow_extra_args(false);
  app.add_flag("--improve", request.improve,
               "Move vertices, on the surface along it, to better the worst angles");
  app.add_option(
         "--coordinates", arguments.coordinates,
         "How vertices are stored: float32 or float64 [float32 where it keeps the angles]")
      ->check(CLI::IsMember({"float32", "float64"}));
  describe_labels(app, arguments.labels);
  app.add_option("--field", arguments.fields, kFieldHelp)
      ->type_name(kFieldType)
      ->allow_extra_args(false);
}

absl::Status check_all_grids(const std::string& input, const std::vector<std::string>& grids) {
  if (grids.empty()) {
    return absl::FailedPreconditionError(absl::StrCat(
        "--all-grids: ", input, " has no grid that can be meshed; `tetstream info` says why"));
  }
  if (absl::Status status = check_grid_names(grids); !status.ok()) {
    return absl::InvalidArgumentError(
        absl::StrCat("--all-grids: ", status.message(), "; name some with --grid"));
  }
  return absl::OkStatus();
}

absl::StatusOr<MeshRequest> understand_request(const RequestArguments& arguments) {
  MeshRequest request = arguments.request;
  request.inside = parse_side(arguments.inside);
  request.preset = *parse_preset(arguments.preset);
  if (arguments.box) {
    const auto [x0, y0, z0, x1, y1, z1] = *arguments.box;
    request.box = {{x0, y0, z0}, {x1, y1, z1}};
  }
  if (arguments.coordinates == "float32") request.coordinates = CoordinateType::kFloat32;
  if (arguments.coordinates == "float64") request.coordinates = CoordinateType::kFloat64;
  absl::StatusOr<Sizing> sizing = read_sizing(arguments.sizing);
  if (!sizing.ok()) return sizing.status();
  request.sizing = *std::move(sizing);
  absl::StatusOr<std::optional<LabelChoice>> labels = understand_labels(arguments.labels);
  if (!labels.ok()) return labels.status();
  request.labels = *std::move(labels);
  request.levels = arguments.levels.value_or(default_levels(request));
  absl::StatusOr<std::vector<VertexField>> fields = understand_fields(arguments.fields);
  if (!fields.ok()) return fields.status();
  request.fields = *std::move(fields);
  absl::StatusOr<std::vector<FaceRegion>> regions = understand_faces(arguments.faces);
  if (!regions.ok()) return regions.status();
  request.face_regions = *std::move(regions);
  request.faces = request.faces || !request.face_regions.empty();
  if (arguments.grids.size() > 1) {
    if (auto status = check_grids(arguments.grids); !status.ok()) return status;
  }
  return request;
}

}  // namespace tet
