#include "client/command/arguments/option_rules.h"

#include <absl/strings/str_format.h>

#include "client/command/arguments/scene_input.h"

namespace tet {

FeatureNames option_names(const MeshRequest& request) {
  FeatureNames names({"the input",
                      "--grid",
                      "several --grid",
                      "a scene",
                      "--iso",
                      "--inside",
                      "--labels",
                      "--preset both-sides",
                      "--box",
                      "--manifold",
                      "--sizing",
                      "the sizing's grid",
                      "the sizing's grade_surface",
                      "--improve",
                      "--field",
                      "--faces",
                      "--face",
                      "fidelity",
                      "--coordinates float64",
                      "--skip-statistics",
                      "a range of chunks",
                      "--packed",
                      "--compact",
                      "an earlier mesh",
                      "a session",
                      "a job",
                      "points"});
  if (request.iso) names.set(Feature::kIso, absl::StrFormat("--iso %g", *request.iso));
  return names;
}

Features features_of(const MeshRequest& request, const MeshInput& input) {
  return features_of(request)
      .add(Feature::kGridName, input.grids.size() == 1)
      .add(Feature::kSeveralGrids, input.grids.size() > 1)
      .add(Feature::kScene, is_scene_file(input.path));
}

absl::Status check_rules(const MeshRequest& request, const MeshInput& input) {
  return check_features(features_of(request, input), option_names(request));
}

}  // namespace tet
