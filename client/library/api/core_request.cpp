#include "client/library/api/core_request.h"

#include <string>
#include <utility>
#include <vector>

#include <absl/status/status.h>
#include <absl/strings/str_cat.h>

#include "client/library/api/labels_impl.h"
#include "client/library/api/scene_impl.h"
#include "client/library/api/volume_impl.h"
#include "proto/convert/face_regions.h"
#include "proto/sizing/sizing_message.h"

namespace tetstream {
namespace {

tet::Preset to_core(Preset preset) {
  switch (preset) {
    case Preset::kDefault:
      return tet::Preset::kDefault;
    case Preset::kMinAngle:
      return tet::Preset::kMinAngle;
    case Preset::kBothSides:
      return tet::Preset::kBothSides;
  }
  return tet::Preset::kDefault;
}

std::optional<tet::CoordinateType> to_core(Coordinates coordinates) {
  switch (coordinates) {
    case Coordinates::kAutomatic:
      return std::nullopt;
    case Coordinates::kFloat32:
      return tet::CoordinateType::kFloat32;
    case Coordinates::kFloat64:
      return tet::CoordinateType::kFloat64;
  }
  return std::nullopt;
}

tet::WorldPoint to_core(const Point& point) { return {point[0], point[1], point[2]}; }

absl::Status about_sizing(const absl::Status& status) {
  return {status.code(), absl::StrCat("sizing: ", status.message())};
}

absl::StatusOr<tet::Sizing> sizing_of(const std::string& json) {
  if (json.empty()) return tet::Sizing();
  const auto message = tet::sizing_from_json(json);
  if (!message.ok()) return about_sizing(message.status());
  if (message->has_grid()) {
    return absl::InvalidArgumentError("sizing: grid is not among what this library takes");
  }
  absl::StatusOr<tet::Sizing> sizing = tet::sizing_of_message(*message);
  if (!sizing.ok()) return about_sizing(sizing.status());
  return sizing;
}

absl::StatusOr<std::vector<tet::FaceRegion>> face_regions_of(const std::string& json) {
  if (json.empty()) return std::vector<tet::FaceRegion>();
  auto regions = tet::face_regions_from_json(json);
  if (regions.ok()) return regions;
  return absl::Status(regions.status().code(),
                      absl::StrCat("face_regions: ", regions.status().message()));
}

std::vector<tet::LabelRange> to_core(const std::vector<LabelRange>& ranges) {
  std::vector<tet::LabelRange> core;
  core.reserve(ranges.size());
  for (const LabelRange& range : ranges) core.push_back({range.first, range.last});
  return core;
}

tet::LabelKernel to_core(LabelSmoothing smoothing) {
  switch (smoothing) {
    case LabelSmoothing::kThin:
      return tet::LabelKernel::kQuadratic;
    case LabelSmoothing::kNone:
      return tet::LabelKernel::kTrilinear;
    default:
      return tet::LabelKernel::kGauss;
  }
}

tet::LabelChoice to_core(const LabelChoice& choice) {
  tet::LabelChoice core;
  core.only = to_core(choice.only);
  for (const auto& merge : choice.merges) core.merges.push_back(to_core(merge));
  core.background = choice.background;
  core.mesh_background = choice.mesh_background;
  for (const MeshLabel& label : choice.names) core.names.push_back({label.value, label.name});
  core.kernel = to_core(choice.smoothing);
  core.smooth = choice.smooth;
  for (const LabelSize& size : choice.sizes) {
    core.sizes.push_back({{size.labels.first, size.labels.last}, size.size});
  }
  return core;
}

}  // namespace

absl::StatusOr<tet::MeshRequest> core_request(const Request& request) {
  absl::StatusOr<tet::Sizing> sizing = sizing_of(request.sizing);
  if (!sizing.ok()) return sizing.status();
  auto regions = face_regions_of(request.face_regions);
  if (!regions.ok()) return regions.status();
  tet::MeshRequest core;
  core.spacing = request.spacing;
  core.iso = request.iso;
  if (request.inside) {
    core.inside =
        *request.inside == Inside::kAbove ? tet::InsideSide::kAbove : tet::InsideSide::kBelow;
  }
  core.preset = to_core(request.preset);
  if (request.box) core.box = {to_core(request.box->min), to_core(request.box->max)};
  core.sizing = *std::move(sizing);
  core.improve = request.improve;
  core.manifold = request.manifold;
  core.face_regions = *std::move(regions);
  core.fidelity = request.fidelity;
  core.faces = request.faces || request.fidelity || !core.face_regions.empty();
  core.skip_statistics = !request.statistics;
  core.coordinates = to_core(request.coordinates);
  for (const Field& field : request.fields) {
    core.fields.push_back({.name = field.name});
    if (field.values) core.fields.back().components = field.values->impl().components;
  }
  if (request.labels) core.labels = to_core(*request.labels);
  core.levels = request.levels.value_or(tet::default_levels(core));
  return core;
}

absl::StatusOr<tet::MeshRequest> local_request(const Request& request) {
  for (const Field& field : request.fields) {
    if (field.values) continue;
    return absl::InvalidArgumentError(absl::StrCat(
        "fields: ", field.name, " has no values; what a server stores is for its own calls"));
  }
  return core_request(request);
}

absl::StatusOr<tet::Shape> shape_of(const Volume& volume) {
  const auto& core = volume.impl().components.front();
  if (tet::has_inside(core->kind)) return tet::Shape(core);
  return absl::FailedPreconditionError(
      "the volume has no inside: it is of VolumeKind::kValues, for the fields of a request");
}

absl::StatusOr<tet::Shape> shape_of(const Scene& scene) {
  if (scene.impl().core != nullptr) return tet::Shape(scene.impl().core);
  return absl::FailedPreconditionError(
      "the scene has grids that a server stores: mesh it there, or give their volumes");
}

absl::StatusOr<tet::Shape> shape_of(const Labels& labels) {
  if (labels.impl().volume == nullptr) return tet::Shape(labels.impl().level_sets);
  return tet::Shape(labels.impl().volume);
}

}  // namespace tetstream
