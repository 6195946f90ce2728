#include "proto/convert/request_rules.h"

#include <string>

#include <absl/strings/str_format.h>

#include "proto/convert/status.h"

namespace tet {
namespace {

absl::Status as_invalid_field(const absl::Status& status) {
  return status.ok() ? status : invalid_field(std::string(status.message()));
}

}  // namespace

Features features_of(const v1::MeshRequest& request) {
  const bool both_sides = request.preset() == v1::PRESET_BOTH_SIDES;
  const bool has_cut = request.has_box() && !request.has_labels() && !both_sides;
  const bool has_faces =
      request.faces() || !request.face_regions().empty() || request.fidelity();
  return Features()
      .add(Feature::kStoredGrid, !request.name().empty())
      .add(Feature::kGridName, !request.grid_name().empty())
      .add(Feature::kSeveralGrids, !request.grid_names().empty())
      .add(Feature::kScene, request.has_scene())
      .add(Feature::kIso, request.has_iso())
      .add(Feature::kInside, request.inside() != v1::INSIDE_UNSPECIFIED)
      .add(Feature::kLabels, request.has_labels())
      .add(Feature::kBothSides, both_sides)
      .add(Feature::kCut, has_cut)
      .add(Feature::kManifold, request.manifold())
      .add(Feature::kSizing, request.has_sizing())
      .add(Feature::kSizingGrid, request.sizing().has_grid())
      .add(Feature::kGradedSurface, request.sizing().grade_surface())
      .add(Feature::kImprove, request.improve())
      .add(Feature::kFields, !request.fields().empty())
      .add(Feature::kFaces, has_faces)
      .add(Feature::kFaceRegions, !request.face_regions().empty())
      .add(Feature::kFidelity, request.fidelity())
      .add(Feature::kFloat64, request.coordinate_type() == v1::COORDINATE_TYPE_FLOAT64)
      .add(Feature::kSkipStatistics, request.skip_statistics());
}

Features features_of(const v1::StreamMeshRequest& request) {
  return features_of(request.mesh())
      .add(Feature::kChunkRange, request.start_chunk() != 0 || request.end_chunk() != 0)
      .add(Feature::kPacked, request.encoding() == v1::ENCODING_PACKED)
      .add(Feature::kCompact, request.encoding() == v1::ENCODING_COMPACT)
      .add(Feature::kEarlierMesh, !request.base_name().empty());
}

FeatureNames names_in(const v1::MeshRequest& request) {
  FeatureNames names = field_names();
  if (request.has_iso()) names.set(Feature::kIso, absl::StrFormat("iso %g", request.iso()));
  return names;
}

absl::Status check_rules(const v1::MeshRequest& request, Features asked_by) {
  return as_invalid_field(check_features(features_of(request) | asked_by, names_in(request)));
}

absl::Status check_rules(const v1::StreamMeshRequest& request) {
  return as_invalid_field(check_features(features_of(request), names_in(request.mesh())));
}

}  // namespace tet
